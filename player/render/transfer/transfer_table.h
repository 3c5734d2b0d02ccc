// Lookup table of a transfer function for one voxel type, and its pre-integrated form (Engel et al. 2001).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "format/content/transfer_curve.h"
#include "format/content/voxel_type.h"

namespace splatlas {

/// A transfer function relative to its maximum extinction. Volumes that differ only by opacity share it.
struct TransferShape {
  struct Point {
    double grey = 0;
    double extinction = 0;  ///< share of the maximum, 0 to 1
    double shade = 1;
    friend auto operator<=>(const Point&, const Point&) = default;
  };
  std::vector<Point> points;  ///< as in TransferCurve
  friend auto operator<=>(const TransferShape&, const TransferShape&) = default;
};

/// `curve` must satisfy check_curve().
[[nodiscard]] TransferShape shape_of(const TransferCurve& curve);

/// Extinction, relative to the maximum, and shade of a grey value.
struct TransferShare {
  float extinction = 0;
  float shade = 0;
};

/// A voxel after classification.
struct ClassifiedVoxel {
  float extinction_per_mm = 0;
  float shade = 0;
};

/// Classification of grey values. Values of 8 and 16 bits are looked up in a table (0.5 MiB for 16 bits)
/// unless `tabulated` is false. Other values are evaluated one by one. Const members are thread-safe.
class TransferTable {
 public:
  TransferTable(const TransferShape& shape, VoxelType type, bool tabulated = true);

  /// Classifies `count` elements `first`, `first + stride`, ... of `values`, which have the type given at
  /// construction. `densest_per_mm` is the maximum extinction. Volumes of type kNone have the optical
  /// properties of the last point; `values` is not read.
  void look_up(const std::byte* values, std::size_t first, std::size_t stride, std::size_t count,
               float densest_per_mm, ClassifiedVoxel* voxels) const;
  /// The same with separate outputs: extinctions, and emissions of white (extinction * shade), 1/mm.
  void look_up(const std::byte* values, std::size_t first, std::size_t stride, std::size_t count,
               float densest_per_mm, float* extinctions, float* emissions) const;
  /// The transfer function at `grey`; NaN sorts before all points.
  [[nodiscard]] TransferShare share_of(double grey) const;
  /// The shares of whole grey values from `lowest` to `highest`, by the lower bits of the value; empty if
  /// values are evaluated one by one.
  struct View {
    std::span<const TransferShare> shares;
    float lowest = 0, highest = 0;
  };
  [[nodiscard]] View view() const { return {table_, lowest_, highest_}; }

 private:
  /// Calls take(n, share) for `count` values.
  template <typename Take>
  void for_each_share(const std::byte* values, std::size_t first, std::size_t stride, std::size_t count,
                      const Take& take) const;

  TransferShape shape_;
  VoxelType type_;
  float lowest_ = 0, highest_ = 0;    // values in the table
  std::vector<TransferShare> table_;  // by the value's bits; empty if values are evaluated one by one
};

/// Affine map from grey values to the stored values that rays sample: (grey - offset) * scale. A stored 0
/// stands for a voxel that is not selected. Bytes are stored unchanged.
struct GreyScale {
  double offset = 0, scale = 1;
  bool bytes = false;

  [[nodiscard]] double stored(double grey) const { return (grey - offset) * scale; }
};

/// Scale with a transparent background value for voxels that are not selected. The background is grey value
/// 0, as in a masked copy, or else the curve's first point. nullopt if both are visible or the volume has no
/// grey values: such volumes need pre-classification.
[[nodiscard]] std::optional<GreyScale> grey_scale(const TransferCurve& curve, VoxelType type);

/// Piecewise linear transfer function over stored grey values, with the integrals that pre-integrated
/// classification needs (Engel et al. 2001). Extinction and shade are linear within a segment between two
/// points. The segment of a grey value is the number of points at or below it.
class PreintegratedTransfer {
 public:
  /// Rows of the table, each with one number per segment. Slopes are per stored grey value.
  enum Row : std::uint8_t {
    kGrey,             ///< stored grey value at the begin of the segment
    kExtinction,       ///< at kGrey, 1/mm
    kExtinctionSlope,  ///< within the segment
    kShade,            ///< at kGrey
    kShadeSlope,       ///< within the segment
    kDepth,            ///< integral of the extinction over grey values, from the first point to kGrey
    kEmission,         ///< integral of extinction * shade, likewise
    kVariation,        ///< total variation of the extinction, likewise
    kVariationSlope,   ///< within the segment
  };
  static constexpr std::size_t kRows = 9;
  static constexpr std::size_t kMaxSegments = (kMaxTransferPoints + 16) / 16 * 16;

  /// `curve` must satisfy check_curve().
  PreintegratedTransfer(const TransferCurve& curve, const GreyScale& scale, double reference_length_mm);

  [[nodiscard]] std::size_t points() const { return points_; }
  /// kMaxSegments numbers, aligned for SIMD loads.
  [[nodiscard]] const float* row(Row row) const { return table_[row].data(); }
  /// Smallest difference of grey values with accurate difference quotients of the integrals.
  [[nodiscard]] float min_difference() const { return min_difference_; }
  /// Total variation of the extinction over all grey values, 1/mm.
  [[nodiscard]] float variation() const { return table_[kVariation][points_]; }
  /// True if the extinction is positive anywhere in [low, high] (stored grey values).
  [[nodiscard]] bool shows(float low, float high) const;

 private:
  [[nodiscard]] float extinction_at(float grey) const;

  std::size_t points_ = 0;
  float min_difference_ = 0;
  alignas(64) std::array<std::array<float, kMaxSegments>, kRows> table_{};
};

}  // namespace splatlas

// Pre-integrated transfer function (Engel et al. 2001) for post-classification.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "format/content/transfer_curve.h"
#include "format/content/voxel_type.h"

namespace splatlas {

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

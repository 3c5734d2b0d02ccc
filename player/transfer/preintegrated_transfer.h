// A transfer function made ready for grey values between voxels: classification after interpolation.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "format/transfer_curve.h"
#include "format/voxel_type.h"

namespace splatlas {

/// How grey values are stored where rays sample them: (grey - offset) * scale, so that 0 stands for
/// "not there". Bytes are stored as they are.
struct GreyScale {
  double offset = 0, scale = 1;
  bool bytes = false;

  [[nodiscard]] double stored(double grey) const { return (grey - offset) * scale; }
};

/// What voxels that are not drawn count as, next to voxels of this curve: grey value 0, as in a masked copy;
/// where the curve shows that, its lowest point's. None where the curve shows that as well, or the volume has
/// no grey values: such volumes can only be classified before interpolation.
[[nodiscard]] std::optional<GreyScale> grey_scale(const TransferCurve& curve, VoxelType type);

/// A transfer function over stored grey values, with its integrals. In each segment between two points
/// extinction and shade are linear, from the segment's first point on; the segment of a grey value is the
/// number of points that are not above it.
class PreintegratedTransfer {
 public:
  /// Rows of the table, each with a number per segment.
  enum Row : std::uint8_t {
    kGrey,             ///< stored grey value that the segment is told from
    kExtinction,       ///< there, 1/mm
    kExtinctionSlope,  ///< per stored grey value
    kShade,            ///< there
    kShadeSlope,
    kDepth,           ///< integral of the extinction over grey values, from the first point to there
    kEmission,        ///< integral of extinction * shade
    kVariation,       ///< what the extinction has risen and fallen by, from the first point to there
    kVariationSlope,  ///< per stored grey value
  };
  static constexpr std::size_t kRows = 9;
  static constexpr std::size_t kMaxSegments = (kMaxTransferPoints + 16) / 16 * 16;

  /// `curve` is one that check_curve() passes.
  PreintegratedTransfer(const TransferCurve& curve, const GreyScale& scale, double reference_length_mm);

  [[nodiscard]] std::size_t points() const { return points_; }
  /// kMaxSegments numbers, aligned for vectors.
  [[nodiscard]] const float* row(Row row) const { return table_[row].data(); }
  /// Grey values closer together than this have no difference quotient worth the name.
  [[nodiscard]] float min_difference() const { return min_difference_; }
  /// What the extinction rises and falls by over all grey values, 1/mm.
  [[nodiscard]] float variation() const { return table_[kVariation][points_]; }
  /// Whether anything is visible from `low` to `high` (stored grey values).
  [[nodiscard]] bool shows(float low, float high) const;

 private:
  [[nodiscard]] float extinction_at(float grey) const;

  std::size_t points_ = 0;
  float min_difference_ = 0;
  alignas(64) std::array<std::array<float, kMaxSegments>, kRows> table_{};
};

}  // namespace splatlas

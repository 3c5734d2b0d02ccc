// Masked copy of a volume for other renderers: 0 outside the selection.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "format/content/atlas_content.h"
#include "format/content/selection.h"
#include "format/result.h"

namespace splatlas::reference {

/// 8-bit grey values, i fastest; 0, the value of the background, outside the selection.
struct MaskedVolume {
  Grid grid;
  std::vector<std::uint8_t> greys;
  /// Per voxel, the PackedNormal of a lit voxel, kUnlit, or kOutside the selection. Empty without normals.
  std::vector<std::int32_t> normals = {};
  std::vector<double> lit = {};  ///< share of a lit voxel's emission that depends on the normal; empty: all
  static constexpr std::int32_t kUnlit = -1, kOutside = -2;

  /// 0 outside the grid.
  [[nodiscard]] std::uint8_t at(std::int64_t i, std::int64_t j, std::int64_t k) const {
    return grid.contains(i, j, k) ? greys[static_cast<std::size_t>(grid.offset(i, j, k))] : std::uint8_t{0};
  }
};

/// The voxels selected as volume, with their normals, if any. kFailed: no 8-bit grey values.
[[nodiscard]] Result<MaskedVolume> masked_volume(const AtlasContent& content, const Selection& selection);

/// Extinction and colour as functions of the grey value: piecewise linear between knots, constant outside.
struct GreyAppearance {
  struct Knot {
    double grey = 0;
    double extinction_per_mm = 0;
    std::array<double, 3> color{0, 0, 0};  ///< linear RGB
  };
  std::vector<Knot> knots;  ///< at least one, in ascending order; equal grey values make a step (the later
                            ///< knot holds there)

  [[nodiscard]] Knot at(double grey) const;
};

/// The transfer function of the volume of a structure (docs/model.md). kFailed if grey value 0 is
/// visible: unselected voxels of a masked copy would show.
[[nodiscard]] Result<GreyAppearance> grey_appearance(const StructureDraw& draw, const Display& display,
                                                     double reference_length_mm);

}  // namespace splatlas::reference

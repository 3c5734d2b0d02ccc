// What every renderer can draw: a copy of the volume, with 0 wherever nothing is selected.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "format/atlas_content.h"
#include "format/result.h"
#include "format/selection.h"

namespace splatlas::reference {

/// Grey values of 8 bits, i fastest; 0, the background's value, outside of the selection ("masked copy").
struct MaskedVolume {
  Grid grid;
  std::vector<std::uint8_t> greys;

  /// 0 beyond the grid.
  [[nodiscard]] std::uint8_t at(std::int64_t i, std::int64_t j, std::int64_t k) const {
    return grid.contains(i, j, k) ? greys[static_cast<std::size_t>(grid.offset(i, j, k))] : std::uint8_t{0};
  }
};

/// The voxels that the selection draws as volume. kFailed when the atlas has no grey values of 8 bits.
[[nodiscard]] Result<MaskedVolume> masked_volume(const AtlasContent& content, const Selection& selection);

/// Extinction and colour as functions of the grey value: piecewise linear between knots, constant beyond the
/// first and the last.
struct GreyAppearance {
  struct Knot {
    double grey = 0;
    double extinction_per_mm = 0;
    std::array<double, 3> color{0, 0, 0};  ///< linear light
  };
  std::vector<Knot>
      knots;  ///< at least one; greys ascend, equal ones make a step (the later one holds there)

  [[nodiscard]] Knot at(double grey) const;
};

/// The transfer function of a structure's volume (docs/model.md). kFailed where it shows a grey value of
/// 0: what is not selected would be seen in a masked copy.
[[nodiscard]] Result<GreyAppearance> grey_appearance(const StructureDraw& draw, const Display& display,
                                                     double reference_length_mm);

}  // namespace splatlas::reference

// Brute-force counts of the voxels, runs and triangles of a frame.
#pragma once

#include <cstdint>

#include "format/atlas_content.h"
#include "format/run_model.h"
#include "format/selection.h"

namespace splatlas {

struct ExpectedCounts {
  std::uint64_t volume = 0, surface = 0, hybrid = 0;  ///< voxels (paper, table 2)
  std::uint64_t runs = 0;       ///< of classes drawn as volume, along scanlines of the principal axis
  std::uint64_t triangles = 0;  ///< of the selected surfaces
};

[[nodiscard]] ExpectedCounts expected_counts(const AtlasContent& content, const Selection& selection,
                                             Axis principal);

}  // namespace splatlas

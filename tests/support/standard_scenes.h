// Standard scenes of error measurements.
#pragma once

#include <string>

#include "format/content/selection.h"
#include "tests/support/test_content.h"

namespace splatlas {

struct StandardScene {
  std::string name;
  AtlasContent content;
  Selection selection;
};

/// The golden phantom as volume: two balls with grey values, opacity 0.3 per voxel.
[[nodiscard]] StandardScene phantom_scene();
/// A smooth field: Gaussian blobs in 40^3 voxels, opacity 0.3 per voxel at their peaks.
[[nodiscard]] StandardScene blobs_scene();
/// The hard case: structures without grey values, opacity 0.9 per voxel, borders one voxel wide.
[[nodiscard]] StandardScene labels_scene();
/// The golden phantom: both balls as volume with translucent surfaces, and their hull.
[[nodiscard]] StandardScene hybrid_scene();

}  // namespace splatlas

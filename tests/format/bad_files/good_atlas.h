// A small atlas with something of everything.
#pragma once

#include <cstdint>

#include "format/atlas_content.h"

namespace splatlas {

namespace good {
enum Structure : std::uint32_t { kAll, kCore, kRim, kNeedle, kKnob };
enum Class : std::uint32_t {
  kEmpty,
  kCoreInterior,
  kCoreBoundary,
  kCoreAndRim,
  kRimBoundary,
  kKnobInterior,
  kKnobBoundary,
  kNeedleCrossed
};
}  // namespace good

/// 10 x 5 x 4 voxels: a group, structures that overlap, an external one, surfaces and normals that are stored
/// and that are fitted, run lists that are shared and that are not, a scene, a source.
[[nodiscard]] AtlasContent good_content();

}  // namespace splatlas

// Small atlas with every feature of the format.
#pragma once

#include <cstdint>

#include "format/content/atlas_content.h"

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

/// 10 x 5 x 4 voxels: a group, overlapping structures, an external one, stored and derived surfaces and
/// normals, shared and separate run lists, a scene, a source.
[[nodiscard]] AtlasContent good_content();

}  // namespace splatlas

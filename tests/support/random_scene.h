// Random atlases with selections and views, for comparing pictures.
#pragma once

#include <cstdint>
#include <string>

#include "player/frame/render_overrides.h"
#include "player/render_frame.h"
#include "tests/support/test_content.h"

namespace splatlas {

struct RandomScene {
  AtlasContent content;
  Selection selection;
  Camera camera;
  RenderOptions options;
  RenderOverrides overrides = {};
};

/// A scene of up to `max_side` voxels a side, from its number alone: the same on every machine. Overlapping
/// balls, boxes and noise in oblique, mirrored and anisotropic grids; grey values of every type,
/// not-a-numbers included; every mode, opacities from 1e-6 to 1, ramps, steps and curves; straight, diagonal
/// and any other direction of view, near and far, off centre; every quality.
[[nodiscard]] RandomScene random_scene(std::uint32_t number, std::int64_t max_side = 12);

/// A whole scene from a seed and its number, with everything at once that random_scene() does not mix:
/// groups, several parents, external surfaces (slivers, triangles without an area and on the planes of voxels
/// among them), selections in words with removals, grey values that are constant, denormal, infinite or as
/// large as their type allows, voxels of one to fifty, grids far away, tiny and huge; rays in perspective,
/// from inside the volume too, and in parallel, grey values classified before and after interpolation.
[[nodiscard]] RandomScene whole_scene(std::uint32_t seed, std::uint32_t number);

/// What a failing test tells.
[[nodiscard]] std::string describe(const RandomScene& scene);

}  // namespace splatlas

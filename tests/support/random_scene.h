// Random atlases with selections and views.
#pragma once

#include <cstdint>
#include <string>

#include "player/render/frame/frame_renderer.h"
#include "player/renderer.h"
#include "tests/support/test_content.h"

namespace splatlas {

struct RandomScene {
  AtlasContent content;
  Selection selection;
  Camera camera;
  RenderOptions options;
  RenderOverrides overrides = {};
};

/// A scene of up to `max_side` voxels a side, determined by its number on every machine. Contains overlapping
/// balls, boxes and noise; oblique, mirrored and anisotropic grids; grey values of every type, not-a-number
/// included; every draw mode; opacities from 1e-6 to 1; ramps, steps and curves; axis-parallel, diagonal and
/// general views, near and far, off centre; every quality.
[[nodiscard]] RandomScene random_scene(std::uint32_t number, std::int64_t max_side = 12);

/// A scene determined by seed and number, which adds to random_scene(): groups; several parents; external
/// surfaces with slivers, degenerate triangles and triangles in planes of voxel centres; selection text with
/// removals; grey values that are constant, denormal, infinite or extreme; voxels stretched by 50 along an
/// axis; distant, tiny and huge grids; rays in parallel and perspective projection, also from inside the
/// volume, with pre- and post-classification.
[[nodiscard]] RandomScene whole_scene(std::uint32_t seed, std::uint32_t number);

/// whole_scene() with one to six planes through its structures: across and along the view and the axes of the
/// grid, at random angles and parallel to each other; every cap mode.
[[nodiscard]] RandomScene cut_scene(std::uint32_t seed, std::uint32_t number);

/// Summary of a scene for failure messages.
[[nodiscard]] std::string describe(const RandomScene& scene);

}  // namespace splatlas

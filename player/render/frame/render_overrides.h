// Overrides of a renderer's choices, for tests.
#pragma once

#include <optional>

#include "format/content/grid.h"
#include "player/render_options.h"

namespace splatlas {

class Renderer;
struct Camera;
struct Frame;

struct RenderOverrides {
  bool simd = true;  ///< false: the scalar reference kernels
  /// Principal axis of the shear-warp factorisation, and of rays within kMaxForcedSlope; other rays keep
  /// their best axis. Not set: the best axis of the view, or of each ray.
  std::optional<Axis> principal_axis = std::nullopt;
  bool one_ray = false;  ///< rays: one through the centre of each pixel, however small voxels are
};

/// Access to the state of a renderer, for tests.
struct RendererInternals {
  /// Renderer::render() with overrides. Sheets: also kUsage beyond kMaxForcedSlope of a forced axis.
  [[nodiscard]] static Result<void> render(Renderer& renderer, const Camera& camera,
                                           const RenderOptions& options, const RenderOverrides& overrides,
                                           Frame& frame, const RenderControl& control);
};

}  // namespace splatlas

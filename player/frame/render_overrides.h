// Overrides of a renderer's choices, for tests.
#pragma once

#include <optional>

#include "format/grid.h"
#include "player/render_options.h"

namespace splatlas {

class Renderer;

struct RenderOverrides {
  bool simd = true;  ///< false: the scalar reference kernels
  /// Principal axis of the shear-warp factorisation, and of rays within kMaxForcedSlope; other rays keep
  /// their best axis. Not set: the best axis of the view, or of each ray.
  std::optional<Axis> principal_axis = std::nullopt;
};

/// Access to the state of a renderer, for render_with().
struct RendererInternals {
  [[nodiscard]] static Result<void> render(Renderer& renderer, const Camera& camera,
                                           const RenderOptions& options, const RenderOverrides& overrides,
                                           Picture& picture, const RenderControl& control);
};

/// Renderer::render() with overrides. Sheets: also kUsage for views beyond kMaxForcedSlope of a forced axis.
[[nodiscard]] Result<void> render_with(Renderer& renderer, const Camera& camera, const RenderOptions& options,
                                       const RenderOverrides& overrides, Picture& picture,
                                       const RenderControl& control = {});
[[nodiscard]] Result<Picture> render_with(Renderer& renderer, const Camera& camera,
                                          const RenderOptions& options, const RenderOverrides& overrides);

}  // namespace splatlas

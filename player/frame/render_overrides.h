// Overrides of a renderer's choices, for tests and benchmarks.
#pragma once

#include <optional>

#include "format/grid.h"
#include "player/render_options.h"

namespace splatlas {

class Renderer;

struct RenderOverrides {
  bool simd = true;  ///< false: the scalar reference kernels
  /// Principal axis of the shear-warp factorisation and of rays. Not set: the best one for the view.
  std::optional<Axis> principal_axis = std::nullopt;
};

/// Renderer::render() with overrides. Also kUsage when the view is parallel to the slices of a forced axis.
[[nodiscard]] Result<void> render_with(Renderer& renderer, const Camera& camera, const RenderOptions& options,
                                       const RenderOverrides& overrides, Picture& picture,
                                       const RenderControl& control = {});
[[nodiscard]] Result<Picture> render_with(Renderer& renderer, const Camera& camera,
                                          const RenderOptions& options, const RenderOverrides& overrides);

}  // namespace splatlas

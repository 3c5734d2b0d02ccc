// Choices that tests and benchmarks force on a renderer.
#pragma once

#include <optional>

#include "format/grid.h"
#include "player/render_options.h"

namespace splatlas {

class Renderer;

struct RenderOverrides {
  bool simd = true;  ///< false: the scalar reference kernels
  /// Of the shear-warp factorisation and of rays, to measure the cost of the choice; the best one when not
  /// set.
  std::optional<Axis> principal_axis = std::nullopt;
};

/// Renderer::render() with forced choices. kUsage when the view runs along the slices of a forced axis.
[[nodiscard]] Result<void> render_with(Renderer& renderer, const Camera& camera, const RenderOptions& options,
                                       const RenderOverrides& overrides, Picture& picture,
                                       const RenderControl& control = {});
[[nodiscard]] Result<Picture> render_with(Renderer& renderer, const Camera& camera,
                                          const RenderOptions& options, const RenderOverrides& overrides);

}  // namespace splatlas

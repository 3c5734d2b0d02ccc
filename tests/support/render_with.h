// Frames with overrides of the renderer's choices.
#pragma once

#include "player/render/frame/frame_renderer.h"
#include "player/renderer.h"

namespace splatlas {

/// RendererInternals::render() into a new frame.
inline Result<Frame> render_with(Renderer& renderer, const Camera& camera, const RenderOptions& options,
                                 const RenderOverrides& overrides) {
  Frame frame;
  const auto rendered = RendererInternals::render(renderer, camera, options, overrides, frame, {});
  return rendered ? Result<Frame>(std::move(frame)) : tl::unexpected(rendered.error());
}

}  // namespace splatlas

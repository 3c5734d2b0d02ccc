#include "player/frame/render_overrides.h"

#include "format/system/result_macros.h"

namespace splatlas {

Result<void> render_with(Renderer& renderer, const Camera& camera, const RenderOptions& options,
                         const RenderOverrides& overrides, Picture& picture, const RenderControl& control) {
  return RendererInternals::render(renderer, camera, options, overrides, picture, control);
}

Result<Picture> render_with(Renderer& renderer, const Camera& camera, const RenderOptions& options,
                            const RenderOverrides& overrides) {
  Picture picture;
  SPLATLAS_RETURN_IF_ERROR(render_with(renderer, camera, options, overrides, picture));
  return picture;
}

}  // namespace splatlas

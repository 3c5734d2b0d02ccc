#include "tests/support/render.h"

#include <cstring>
#include <stdexcept>
#include <string>

#include "tests/support/render_with.h"

namespace splatlas {

Renderer renderer_of(const AtlasContent& content, const Selection& selection, unsigned threads) {
  Renderer renderer(open_in_memory(content), {.threads = threads});
  if (auto selected = renderer.select(selection); !selected) {
    throw std::runtime_error(selected.error().message);
  }
  return renderer;
}

Frame frame_or_throw(Renderer& renderer, const Camera& camera, const RenderOptions& options,
                     const RenderOverrides& overrides) {
  return value_or_throw(render_with(renderer, camera, options, overrides));
}

Picture render_or_throw(Renderer& renderer, const Camera& camera, const RenderOptions& options,
                        const RenderOverrides& overrides) {
  return frame_or_throw(renderer, camera, options, overrides).picture;
}

Picture render_or_throw(const AtlasContent& content, const Selection& selection, const Camera& camera,
                        const RenderOptions& options, unsigned threads, const RenderOverrides& overrides) {
  Renderer renderer = renderer_of(content, selection, threads);
  return render_or_throw(renderer, camera, options, overrides);
}

Picture render_with_threads(const AtlasContent& content, const Selection& selection, const Camera& camera,
                            const RenderOptions& options, const RenderOverrides& overrides) {
  Picture one = render_or_throw(content, selection, camera, options, 1, overrides);
  for (const unsigned threads : {2u, 8u}) {
    const Picture several = render_or_throw(content, selection, camera, options, threads, overrides);
    if (several.rgba != one.rgba ||
        std::memcmp(several.rgba.data(), one.rgba.data(), one.rgba.size() * sizeof(float)) != 0)
      throw std::runtime_error(std::to_string(threads) + " threads give other bits");
  }
  return one;
}

double zoom_for(const Display& display, int picture_side, double mm_per_pixel) {
  return 2 * display.radius_mm / (0.96 * picture_side * mm_per_pixel);
}

Selection without(Selection selection, const std::vector<MissingPart>& missing) {
  for (const MissingPart& part : missing) {
    DrawMode& mode = selection.structures[part.structure].mode;
    const DrawMode other = part.surface ? DrawMode::kVolume : DrawMode::kSurface;
    mode = mode == DrawMode::kBoth ? other : DrawMode::kOff;
  }
  return selection;
}

}  // namespace splatlas

#include "tests/support/render.h"

#include <stdexcept>

#include "tests/support/value_or_throw.h"

namespace splatlas {

Picture render_or_throw(Renderer& renderer, const Camera& camera, const RenderOptions& options,
                        const RenderOverrides& overrides) {
  return value_or_throw(render_with(renderer, camera, options, overrides));
}

Picture render_or_throw(const AtlasContent& content, const Selection& selection, const Camera& camera,
                        const RenderOptions& options, unsigned threads, const RenderOverrides& overrides) {
  Renderer renderer(open_in_memory(content), {threads, 0});
  if (auto selected = renderer.select(selection); !selected) {
    throw std::runtime_error(selected.error().message);
  }
  return render_or_throw(renderer, camera, options, overrides);
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

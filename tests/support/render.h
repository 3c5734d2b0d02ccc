// One-call rendering of test atlases.
#pragma once

#include <vector>

#include "player/render/frame/frame_renderer.h"
#include "player/renderer.h"
#include "tests/support/test_content.h"

namespace splatlas {

/// A renderer with a selection. Throws std::runtime_error with the library's message.
[[nodiscard]] Renderer renderer_of(const AtlasContent& content, const Selection& selection,
                                   unsigned threads = 1);

/// Renders. Throws std::runtime_error with the library's message.
[[nodiscard]] Frame frame_or_throw(Renderer& renderer, const Camera& camera,
                                   const RenderOptions& options = {}, const RenderOverrides& overrides = {});
/// The same, for the picture alone.
[[nodiscard]] Picture render_or_throw(Renderer& renderer, const Camera& camera,
                                      const RenderOptions& options = {},
                                      const RenderOverrides& overrides = {});
[[nodiscard]] Picture render_or_throw(const AtlasContent& content, const Selection& selection,
                                      const Camera& camera, const RenderOptions& options = {},
                                      unsigned threads = 1, const RenderOverrides& overrides = {});

/// With 1, 2 and 8 threads; also throws if their bits differ.
[[nodiscard]] Picture render_with_threads(const AtlasContent& content, const Selection& selection,
                                          const Camera& camera, const RenderOptions& options = {},
                                          const RenderOverrides& overrides = {});

/// The zoom at which a pixel of a square picture is `mm_per_pixel` wide.
[[nodiscard]] double zoom_for(const Display& display, int picture_side, double mm_per_pixel);

/// The selection without the missing parts of a damaged file.
[[nodiscard]] Selection without(Selection selection, const std::vector<MissingPart>& missing);

}  // namespace splatlas

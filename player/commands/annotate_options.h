// Options of annotations, and the annotations of a rendered picture.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "format/content/selection.h"
#include "format/result.h"
#include "player/camera.h"
#include "player/files/text_drawer.h"
#include "player/page/annotate_picture.h"
#include "player/render_frame.h"

namespace CLI {
class App;
}

namespace splatlas {

/// Arguments of --annotate and the options that need it.
struct AnnotateRequest {
  AnnotationItems items;
  std::optional<std::string> caption;  ///< not set: the title of the atlas
  std::size_t max_labels = AnnotationOptions{}.max_labels;
  std::optional<double> dpi;
  std::filesystem::path font;  ///< empty: a font of the system
};

/// Adds the options. Errors are those of add_render().
void add_annotations(CLI::App& command, AnnotateRequest& request);

/// Parses a list of items: "labels,legend". kUsage, with the valid names.
[[nodiscard]] Result<AnnotationItems> parse_annotations(std::string_view text);

/// Region of the picture that leaves room for the annotations around the selection. Renders a small draft if
/// labels or a legend are wanted. `drawer` is ready after this. `camera`: its zoom and centre do not matter.
/// Errors of fonts, of modules and of the renderer.
[[nodiscard]] Result<PictureRegion> region_beside_annotations(Renderer& renderer, const Selection& selection,
                                                              const Camera& camera,
                                                              const RenderOptions& options,
                                                              const AnnotateRequest& request,
                                                              TextDrawer& drawer);

/// Lays out the annotations of the renderer's latest picture. `drawer` is ready after this. Picks at most
/// some ten thousand pixels if labels or a legend are wanted. Errors of fonts, modules and layout.
[[nodiscard]] Result<AnnotationLayer> annotate_rendered(const Renderer& renderer, const Selection& selection,
                                                        const Picture& picture, const View& view,
                                                        std::optional<Rgb> background,
                                                        const AnnotateRequest& request, TextDrawer& drawer);

}  // namespace splatlas

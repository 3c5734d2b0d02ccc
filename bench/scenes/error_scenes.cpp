#include "bench/scenes/error_scenes.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "bench/measure/frames.h"
#include "format/content/class_table.h"
#include "format/result_macros.h"

namespace splatlas {
namespace {

/// Frames the bounding ball of the bounding box of a selection.
void zoom_to(const AtlasContent& content, const Selection& selection, Camera& camera) {
  const Grid grid = storage_grid(content);
  IndexBox box;
  for (ClassId c = 0; c < content.classes.size(); ++c) {
    for (const Membership& member : content.classes.members(c)) {
      if (selection.structures[member.structure].mode != DrawMode::kOff) box.include(content.classes.box(c));
    }
  }
  Vec3 middle{};
  double diagonal = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    middle[a] = 0.5 * static_cast<double>(box.first[a] + box.last[a]);
    diagonal += std::pow(static_cast<double>(box.last[a] + 1 - box.first[a]) * grid.spacing_mm[a], 2);
  }
  camera.center_lps_mm = index_to_lps_mm(grid).apply(middle);
  camera.zoom = content.display.radius_mm / (0.5 * std::sqrt(diagonal));
}

}  // namespace

std::span<const ErrorScene> error_scenes() {
  static constexpr std::array kScenes{
      ErrorScene{"head", "Head", false},
      ErrorScene{"brain", "\"Left hemisphere\" + \"Right hemisphere\" + Vermis", false},
      ErrorScene{"left", "\"Left hemisphere\"", false},
      ErrorScene{"one", "Hippocampus_L + Amygdala_L", true},
  };
  return kScenes;
}

std::span<const ErrorAppearance> error_appearances() {
  static constexpr std::array kAppearances{
      ErrorAppearance{"soft", "opacity=0.3,color=#ffffff"},
      ErrorAppearance{"thin", "profile=thin,opacity=0.01,color=#ffffff"},
      ErrorAppearance{"hard", "profile=hard,opacity=0.95,color=#ffffff"},
  };
  return kAppearances;
}

std::string selection_text(std::string_view structures, std::string_view options) {
  std::string text;
  while (!structures.empty()) {
    const std::size_t end = std::min(structures.find(" + "), structures.size());
    text += fmt::format("{}{}:volume({})", text.empty() ? "" : " + ", structures.substr(0, end), options);
    structures.remove_prefix(std::min(end + 3, structures.size()));
  }
  return text;
}

Result<ErrorModel> error_model(const AtlasContent& content, std::string_view selection) {
  ErrorModel model;
  SPLATLAS_ASSIGN_OR_RETURN(model.selection, Selection::parse(selection, content.graph));
  SPLATLAS_ASSIGN_OR_RETURN(model.volume, reference::masked_volume(content, model.selection));
  const StructureDraw& drawn =
      *std::ranges::find_if(model.selection.structures, [](const StructureDraw& draw) {
        return draw.mode == DrawMode::kVolume || draw.mode == DrawMode::kBoth;
      });
  SPLATLAS_ASSIGN_OR_RETURN(
      model.appearance,
      reference::grey_appearance(drawn, content.display, reference_length_mm(model.volume.grid)));
  model.camera = oblique_camera();
  return model;
}

Result<ErrorModel> error_model(const AtlasContent& content, const ErrorScene& scene,
                               const ErrorAppearance& appearance) {
  SPLATLAS_ASSIGN_OR_RETURN(ErrorModel model,
                            error_model(content, selection_text(scene.structures, appearance.options)));
  if (scene.fills_picture) zoom_to(content, model.selection, model.camera);
  return model;
}

}  // namespace splatlas

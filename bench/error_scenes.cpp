#include "bench/error_scenes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "format/system/result_macros.h"

namespace splatlas {
namespace {

std::string selection_text(const ErrorScene& scene, const ErrorAppearance& appearance) {
  std::string text;
  std::string_view names = scene.structures;
  while (!names.empty()) {
    const std::size_t end = std::min(names.find(" + "), names.size());
    text +=
        fmt::format("{}{}:volume({})", text.empty() ? "" : " + ", names.substr(0, end), appearance.options);
    names.remove_prefix(std::min(end + 3, names.size()));
  }
  return text;
}

/// Frames the bounding ball of the bounding box of all voxels that are not 0.
void zoom_to(const reference::MaskedVolume& volume, const Display& display, Camera& camera) {
  const Grid& grid = volume.grid;
  Index3 low = grid.size, high{-1, -1, -1};
  for (std::int64_t k = 0; k < grid.size[2]; ++k) {
    for (std::int64_t j = 0; j < grid.size[1]; ++j) {
      for (std::int64_t i = 0; i < grid.size[0]; ++i) {
        if (volume.at(i, j, k) == 0) continue;
        const Index3 voxel{i, j, k};
        for (std::size_t a = 0; a < 3; ++a) {
          low[a] = std::min(low[a], voxel[a]);
          high[a] = std::max(high[a], voxel[a]);
        }
      }
    }
  }
  if (high[0] < 0) return;
  Vec3 middle{};
  double diagonal = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    middle[a] = 0.5 * static_cast<double>(low[a] + high[a]);
    diagonal += std::pow(static_cast<double>(high[a] + 1 - low[a]) * grid.spacing_mm[a], 2);
  }
  camera.center_lps_mm = index_to_lps_mm(grid).apply(middle);
  camera.zoom = display.radius_mm / (0.5 * std::sqrt(diagonal));
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

Result<ErrorModel> error_model(const AtlasContent& content, const ErrorScene& scene,
                               const ErrorAppearance& appearance) {
  ErrorModel model;
  SPLATLAS_ASSIGN_OR_RETURN(model.selection, select(selection_text(scene, appearance), content.graph));
  SPLATLAS_ASSIGN_OR_RETURN(model.volume, reference::masked_volume(content, model.selection));
  const auto drawn = std::find_if(model.selection.structures.begin(), model.selection.structures.end(),
                                  [](const StructureDraw& draw) { return draw.mode != DrawMode::kOff; });
  SPLATLAS_ASSIGN_OR_RETURN(
      model.appearance,
      reference::grey_appearance(*drawn, content.display, reference_length_mm(model.volume.grid)));
  model.camera = oblique_camera();
  if (scene.fills_picture) zoom_to(model.volume, content.display, model.camera);
  return model;
}

}  // namespace splatlas

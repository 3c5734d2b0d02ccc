#include "bench/hybrid_scenes.h"

#include <algorithm>
#include <array>

#include "format/decision_tree.h"
#include "format/system/result_macros.h"

namespace splatlas {

std::span<const HybridScene> hybrid_scenes() {
  static constexpr std::array kScenes{
      HybridScene{"translucent half",
                  "\"Left hemisphere\":volume(opacity=0.3,color=#ffffff) + "
                  "\"Right hemisphere\":surface(opacity=0.4)",
                  VtkVolumeMapper::kGpu},
      HybridScene{"translucent brain",
                  "\"Left hemisphere\":both(opacity=0.4,color=#ffffff) + "
                  "\"Right hemisphere\":both(opacity=0.4,color=#ffffff)",
                  VtkVolumeMapper::kGpu},
      HybridScene{"opaque half",
                  "\"Left hemisphere\":volume(opacity=0.3,color=#ffffff) + \"Right hemisphere\":surface",
                  VtkVolumeMapper::kFixedPoint},
  };
  return kScenes;
}

Result<HybridModel> hybrid_model(const AtlasContent& content, const HybridScene& scene) {
  HybridModel model;
  SPLATLAS_ASSIGN_OR_RETURN(model.selection, select(scene.selection, content.graph));
  SPLATLAS_ASSIGN_OR_RETURN(model.volume, reference::masked_volume(content, model.selection));
  model.surfaces = DecisionTree(content.graph, content.classes).plan(model.selection).surfaces;
  for (const StructureIndex s : model.surfaces) model.triangles += content.surfaces[s].triangles.size();
  const auto drawn = std::find_if(model.selection.structures.begin(), model.selection.structures.end(),
                                  [](const StructureDraw& draw) {
                                    return draw.mode == DrawMode::kVolume || draw.mode == DrawMode::kBoth;
                                  });
  SPLATLAS_ASSIGN_OR_RETURN(
      model.appearance,
      reference::grey_appearance(*drawn, content.display, reference_length_mm(model.volume.grid)));
  return model;
}

Camera hybrid_camera(int turn) {
  Camera camera;
  camera.azimuth_deg = 30 + 15 * turn;
  camera.elevation_deg = 20;
  return camera;
}

}  // namespace splatlas

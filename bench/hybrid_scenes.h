// Surfaces mixed with volume: the scenes of the bench `hybrid`.
#pragma once

#include <span>
#include <string>

#include "bench/peers/vtk_peer.h"
#include "format/atlas_content.h"
#include "format/selection.h"
#include "player/camera.h"
#include "tests/reference/masked_volume.h"

namespace splatlas {

/// Parts of the Colin 27 head, and which renderer of VTK's they are compared with.
struct HybridScene {
  const char* name;
  const char* selection;   ///< all volumes look alike
  VtkVolumeMapper mapper;  ///< kGpu: surfaces are translucent, and VTK peels depths
};
[[nodiscard]] std::span<const HybridScene> hybrid_scenes();

/// A scene as every renderer gets it.
struct HybridModel {
  Selection selection;
  std::vector<StructureIndex> surfaces;
  std::uint64_t triangles = 0;
  reference::MaskedVolume volume;
  reference::GreyAppearance appearance;
};
[[nodiscard]] Result<HybridModel> hybrid_model(const AtlasContent& content, const HybridScene& scene);

/// The camera of a turn: 15 degrees further each.
[[nodiscard]] Camera hybrid_camera(int turn);

}  // namespace splatlas

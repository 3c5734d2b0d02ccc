// Scenes of the bench `hybrid`: surfaces mixed with volume.
#pragma once

#include <span>
#include <string>

#include "bench/peers/vtk_peer.h"
#include "format/atlas_content.h"
#include "format/selection.h"
#include "player/camera.h"
#include "tests/reference/masked_volume.h"

namespace splatlas {

/// Parts of the Colin 27 head, and the VTK renderer to compare.
struct HybridScene {
  const char* name;
  const char* selection;   ///< all volumes have one appearance
  VtkVolumeMapper mapper;  ///< kGpu: translucent surfaces, with depth peeling
};
[[nodiscard]] std::span<const HybridScene> hybrid_scenes();

/// A scene, in the form that all renderers take.
struct HybridModel {
  Selection selection;
  std::vector<StructureIndex> surfaces;
  std::uint64_t triangles = 0;
  reference::MaskedVolume volume;
  reference::GreyAppearance appearance;
};
[[nodiscard]] Result<HybridModel> hybrid_model(const AtlasContent& content, const HybridScene& scene);

/// The camera of a turn, in steps of 15 degrees.
[[nodiscard]] Camera hybrid_camera(int turn);

}  // namespace splatlas

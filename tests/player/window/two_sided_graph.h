// Small graph in which gyri have two parents, as in an atlas by side and by lobe.
#pragma once

#include <vector>

#include "format/content/structure_graph.h"

namespace splatlas::two_sided {

enum Index : StructureIndex { kBrain, kLeft, kRight, kLobe, kGyrusLeft, kGyrusRight, kStem };

[[nodiscard]] inline StructureGraph graph() {
  const auto structure = [](const char* id, const char* name, std::vector<StructureIndex> parents) {
    return Structure{.id = id,
                     .name = name,
                     .color = {200, 100, 50},
                     .label = std::nullopt,
                     .parents = std::move(parents),
                     .external = false};
  };
  return *StructureGraph::build(
      {structure("brain", "Brain", {}), structure("left", "Left side", {kBrain}),
       structure("right", "Right side", {kBrain}), structure("lobe", "Frontal lobe", {kBrain}),
       structure("gyrus_l", "Gyrus, left", {kLeft, kLobe}),
       structure("gyrus_r", "Gyrus, right", {kRight, kLobe}), structure("stem", "Brain stem", {kBrain})});
}

/// Only gyri and stem have voxels.
[[nodiscard]] inline std::vector<bool> drawable() {
  return {false, false, false, false, true, true, true};
}

}  // namespace splatlas::two_sided

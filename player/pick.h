// Result of picking: the structure under a point of a picture.
#pragma once

#include "format/grid.h"
#include "format/structure_graph.h"

namespace splatlas {

/// The structure that contributes most to a pixel, and the point on its ray with the largest contribution.
struct Pick {
  StructureIndex structure = kNoStructure;
  Vec3 point_lps_mm{0, 0, 0};
};

}  // namespace splatlas

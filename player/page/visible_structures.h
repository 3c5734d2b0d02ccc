// Structures visible in a picture, with anchors for leader lines.
#pragma once

#include <functional>
#include <vector>

#include "format/content/structure_graph.h"
#include "player/page/annotation.h"
#include "player/picture.h"

namespace splatlas {

/// Darkens a picture at its outlines: between pixels that show different structures, and where depths of
/// neighbours differ by more than 12 pixels, as at folds; not between translucent pixels. Lines are a pixel
/// wide, or a 900th of the picture's short side, with soft edges. `ids` and `depths`: of one frame.
void draw_outlines(const IdImage& ids, const DepthMap& depths, double mm_per_pixel, Picture& picture);

/// Structures at regular samples of a picture. Sample (i, j) is at ((i + 0.5) * step, (j + 0.5) * step).
struct IdGrid {
  int columns = 0, rows = 0;
  double step = 1;                  ///< pixels between samples
  std::vector<StructureIndex> ids;  ///< kNoStructure for the background; top row first
};

/// One structure of a picture.
struct VisibleStructure {
  StructureIndex structure = kNoStructure;
  double pixels = 0;  ///< visible area
  PagePoint anchor;   ///< a sample of the structure, deep inside its visible region
};

/// Structure at picture coordinates, or kNoStructure.
using StructureAt = std::function<StructureIndex(double x, double y)>;

/// Samples a picture at `max_samples` points at most. Transparent pixels are not asked for.
[[nodiscard]] IdGrid sample_structures(const Picture& picture, const StructureAt& at, int max_samples);

/// The structures of a grid, in index order. Anchors are nearly farthest from the border of their region
/// (chamfer distance, Borgefors 1986), and then nearest to its centroid. O(samples + structures).
[[nodiscard]] std::vector<VisibleStructure> visible_structures(const IdGrid& grid);

}  // namespace splatlas

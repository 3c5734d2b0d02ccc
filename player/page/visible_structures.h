// Structures visible in a picture, with anchors for leader lines.
#pragma once

#include <functional>
#include <vector>

#include "format/content/structure_graph.h"
#include "player/page/annotation.h"
#include "player/picture.h"

namespace splatlas {

/// Darkens a picture along lines of this width in pixels, at least 1: between pixels that show different
/// structures, and where depths of neighbours differ by more than 12 widths, as at folds; not where the
/// picture of the `solids` is translucent. `solids`, `ids`, `depths`: of one frame. O(pixels * width^2).
void draw_outlines(const Picture& solids, const IdImage& ids, const DepthMap& depths, double mm_per_pixel,
                   double width, Picture& picture);

/// Structures at regular samples of a picture. Sample (i, j) is at ((i + 0.5) * step, (j + 0.5) * step).
struct IdGrid {
  int columns = 0, rows = 0;
  double step = 1;                  ///< pixels between samples
  std::vector<StructureIndex> ids;  ///< kNoStructure for the background; top row first
};

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

#include <algorithm>
#include <cstdint>
#include <vector>

#include "tests/fuzz/mutators.h"
#include "tests/support/sparse_atlas.h"

namespace splatlas {
namespace {

constexpr ClassId kMaxShapes = 12;
constexpr std::int64_t kMaxPlateSide = 40;

/// The same share of the axis.
std::int64_t stretch(std::int64_t at, std::int64_t before, std::int64_t now) {
  return std::clamp<std::int64_t>(at, 0, before - 1) * (now - 1) / std::max<std::int64_t>(before - 1, 1);
}

/// Voxels at two corners, or a plate of one voxel's thickness from the first corner.
SparseStructure shape_in(const IndexBox& box, Random& random) {
  if (below(2, random) == 0) return {voxel_box(box.first), voxel_box(box.last)};
  IndexBox plate = box;
  for (std::size_t a = 0; a < 3; ++a)
    plate.last[a] = std::min(plate.last[a], plate.first[a] + kMaxPlateSide - 1);
  const std::size_t thin = below(3, random);
  plate.last[thin] = plate.first[thin];
  return {plate};
}

}  // namespace

Bytes stretched_atlas(const Directory& directory, Random& random) {
  // Choose another size of one axis, of any magnitude
  Index3 before{};
  for (std::size_t a = 0; a < 3; ++a)
    before[a] = directory.source_grid.size[directory.source_to_storage.from[a]];
  Index3 size = before;
  const std::size_t axis = below(3, random);
  const std::int64_t others = size[0] * size[1] * size[2] / size[axis];
  const std::int64_t wanted =
      (std::int64_t{1} << below(25, random)) - static_cast<std::int64_t>(below(2, random));
  size[axis] = std::clamp<std::int64_t>(wanted, 1, std::min(kMaxAxisSize, kMaxVoxels / others));

  // Place the shapes that fit next to earlier ones
  std::vector<SparseStructure> structures;
  std::vector<IndexBox> placed;
  for (ClassId c = 1; c < std::min<std::size_t>(directory.classes.size(), kMaxShapes); ++c) {
    IndexBox box = directory.classes.box(c);
    if (box.empty()) continue;
    for (std::size_t a = 0; a < 3; ++a) {
      box.first[a] = stretch(box.first[a], before[a], size[a]);
      box.last[a] = std::max(box.first[a], stretch(box.last[a], before[a], size[a]));
    }
    SparseStructure structure;
    for (const IndexBox& part : shape_in(box, random)) {
      if (std::ranges::any_of(placed, [&](const IndexBox& other) { return are_near(part, other); })) continue;
      placed.push_back(part);
      structure.push_back(part);
    }
    if (!structure.empty()) structures.push_back(std::move(structure));
  }
  if (structures.empty()) structures.push_back({voxel_box({0, 0, 0})});
  return sparse_atlas(size, structures);
}

}  // namespace splatlas

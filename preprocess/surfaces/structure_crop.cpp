#include "preprocess/surfaces/structure_crop.h"

#include <algorithm>

namespace splatlas {

std::vector<std::uint8_t> parts_of(const ClassTable& classes, StructureIndex structure) {
  std::vector<std::uint8_t> parts(classes.size(), 0);
  for (ClassId c = 0; c < classes.size(); ++c) {
    for (const Membership& m : classes.members(c)) {
      if (m.structure == structure && m.part != Part::kCrossed) parts[c] = m.part == Part::kBoundary ? 2 : 1;
    }
  }
  return parts;
}

StructureCrop crop_structure(std::span<const ClassId> volume, const Index3& size, const IndexBox& box,
                             std::span<const std::uint8_t> parts) {
  StructureCrop crop;
  for (std::size_t a = 0; a < 3; ++a) {
    crop.first[a] = box.first[a] - 1;
    crop.size[a] = box.last[a] - box.first[a] + 3;
  }
  crop.inside.resize(static_cast<std::size_t>(crop.size[0] * crop.size[1] * crop.size[2]), 0);
  for (std::int64_t k = box.first[2]; k <= box.last[2]; ++k) {
    for (std::int64_t j = box.first[1]; j <= box.last[1]; ++j) {
      const ClassId* const from =
          &volume[static_cast<std::size_t>((k * size[1] + j) * size[0] + box.first[0])];
      std::uint8_t* const to = &crop.inside[crop.offset(1, j - crop.first[1], k - crop.first[2])];
      const std::int64_t count = box.last[0] - box.first[0] + 1;
      for (std::int64_t i = 0; i < count; ++i) to[i] = parts[from[i]] != 0;
    }
  }
  return crop;
}

}  // namespace splatlas

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "preprocess/import/import_error.h"
#include "preprocess/sources/import_sources.h"

namespace splatlas {

std::vector<std::uint8_t> sides_of_plane(const Grid& grid, double x_mm) {
  const Affine to_mm = index_to_lps_mm(grid);
  const double least = x_mm - 1e-6 * std::ranges::min(grid.spacing_mm);  // despite rounding
  std::vector<std::uint8_t> sides;
  sides.reserve(static_cast<std::size_t>(grid.voxels()));
  for (std::int64_t v = 0; v < grid.voxels(); ++v) {
    const std::int64_t row = v / grid.size[0], j = row % grid.size[1], k = row / grid.size[1];
    const Vec3 index{static_cast<double>(v % grid.size[0]), static_cast<double>(j), static_cast<double>(k)};
    sides.push_back(to_mm.apply(index)[0] >= least ? 1 : 2);
  }
  return sides;
}

Result<std::vector<std::uint8_t>> sides_of_image(const VoxelBuffer& image,
                                                 const std::filesystem::path& file) {
  return visit_voxel_type(image.type, [&]<typename T>(T) -> Result<std::vector<std::uint8_t>> {
    std::vector<std::uint8_t> sides;
    for (const T value : std::span(image.as<T>(), image.bytes.size() / sizeof(T))) {
      if (value != T(0) && value != T(1) && value != T(2))
        return bad_file(file, "holds the value {}; the sides are 1 (left) and 2 (right)", value);
      sides.push_back(static_cast<std::uint8_t>(value));
    }
    for (const int side : {1, 2}) {
      if (std::ranges::find(sides, side) == sides.end())
        return bad_file(file, "has no voxel of {} within the grid; the sides are 1 (left) and 2 (right)",
                        side);
    }
    return sides;
  });
}

void split_sides(SourceModel& model, std::span<const std::uint8_t> sides, const std::string& where,
                 Notes& notes) {
  constexpr std::uint64_t kLeastShare = 100;  // one of so many voxels
  const auto sets = model.memberships.sets();
  std::vector<std::array<std::uint64_t, 3>> of_set(sets.size()), voxels(model.structures.size());
  for (std::size_t v = 0; v < sides.size(); ++v) ++of_set[model.memberships.voxels()[v]][sides[v]];
  for (std::size_t set = 0; set < sets.size(); ++set) {
    for (const StructureIndex s : sets[set]) {
      for (std::size_t side = 0; side < 3; ++side) voxels[s][side] += of_set[set][side];
    }
  }
  std::vector<std::array<StructureIndex, 3>> numbers;  // [structure][side]
  for (StructureIndex s = 0; s < voxels.size(); ++s) {
    numbers.push_back({s, s, s});
    const auto [none, left, right] = voxels[s];
    if (left == 0 || right == 0 || kLeastShare * std::min(left, right) < none + left + right) continue;
    const SourceStructure whole = model.structures[s];
    notes.add("split-structures", fmt::format("{} ({} and {} voxels)", whole.name, left, right));
    for (const std::size_t side : {1, 2}) {
      numbers[s][side] = static_cast<StructureIndex>(model.structures.size());
      SourceStructure& part = model.structures.emplace_back();
      part.name = whole.name + (side == 1 ? " left" : " right");
      part.color = whole.color;
      part.whole = s;
    }
  }
  if (numbers.size() == model.structures.size()) return notes.add("sides-unused", where);
  model.memberships.combine(sides, [&](std::vector<StructureIndex> set, std::uint8_t side) {
    for (StructureIndex& s : set) s = numbers[s][side];
    std::ranges::sort(set);
    return set;
  });
}

}  // namespace splatlas

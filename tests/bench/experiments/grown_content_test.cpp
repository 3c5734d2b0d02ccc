#include "bench/experiments/grown_content.h"

#include <cmath>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "format/atlas_writer.h"
#include "tests/format/random_content.h"
#include "tests/support/neighbours.h"

namespace splatlas {
namespace {

using Members = std::vector<Membership>;

Members members_at(const AtlasContent& content, const Index3& at) {
  const auto offset = static_cast<std::size_t>(storage_grid(content).offset(at[0], at[1], at[2]));
  const auto members = content.classes.members(content.class_volume[offset]);
  return {members.begin(), members.end()};
}

std::vector<std::byte> value_at(const AtlasContent& content, const Index3& at) {
  const auto offset = storage_grid(content).offset(at[0], at[1], at[2]);
  const auto bytes = static_cast<std::ptrdiff_t>(bytes_of(content.values.type));
  const auto first = content.values.bytes.begin() + offset * bytes;
  return {first, first + bytes};
}

/// The voxel of `content` nearest to voxel `at` of `grid`; it may lie outside.
Index3 nearest(const AtlasContent& content, const Grid& grid, const Index3& at) {
  const Vec3 lps = index_to_lps_mm(grid).apply({double(at[0]), double(at[1]), double(at[2])});
  const Vec3 index = lps_mm_to_index(storage_grid(content)).apply(lps);
  return {std::llround(index[0]), std::llround(index[1]), std::llround(index[2])};
}

RC_GTEST_PROP(GrownContent, SurroundedKeepsWhatIsInTheMiddle, ()) {
  auto random = *random_source();
  const AtlasContent content = random_content(random, {.max_side = 7});
  const Index3 times{*rc::gen::inRange(1, 4), *rc::gen::inRange(1, 4), *rc::gen::inRange(1, 4)};
  const auto grown = surrounded(content, times);
  RC_ASSERT(grown.has_value());
  RC_ASSERT(encode_atlas(*grown).has_value());  // checks counts, boxes, order and normals
  const Grid grid = storage_grid(*grown);
  const Grid old = storage_grid(content);
  std::int64_t own = 0;
  for_each_voxel(grid.size, [&](const Index3& at) {
    const Index3 from = nearest(content, grid, at);
    if (old.contains(from[0], from[1], from[2])) {
      ++own;
      RC_ASSERT(members_at(*grown, at) == members_at(content, from));
      RC_ASSERT(value_at(*grown, at) == value_at(content, from));
      return;
    }
    const auto copies = static_cast<StructureIndex>(content.graph.size());
    for (const Membership& member : members_at(*grown, at)) {
      RC_ASSERT(member.structure >= copies);
      const Structure& structure = grown->graph[member.structure];
      RC_ASSERT(structure.id == "around_" + content.graph[member.structure - copies].id);
    }
  });
  RC_ASSERT(own == old.voxels());
}

RC_GTEST_PROP(GrownContent, RefinedTakesTheNearestVoxel, ()) {
  auto random = *random_source();
  const AtlasContent content = random_content(random, {.max_side = 7});
  const Grid old = storage_grid(content);
  Index3 size{};
  // Odd multiples: no place lies midway between two voxels.
  for (std::size_t a = 0; a < 3; ++a) size[a] = old.size[a] * (1 + 2 * *rc::gen::inRange(0, 2));
  const AtlasContent grown = refined(content, size);
  RC_ASSERT(encode_atlas(grown).has_value());
  const Grid grid = storage_grid(grown);
  RC_ASSERT(grid.size == size);
  for_each_voxel(size, [&](const Index3& at) {
    const Index3 from = nearest(content, grid, at);
    RC_ASSERT(members_at(grown, at) == members_at(content, from));
    RC_ASSERT(value_at(grown, at) == value_at(content, from));
  });
}

TEST(GrownContent, RefinedTakesEveryVoxelOnceWhenNothingGrows) {
  std::mt19937 random(7);
  const AtlasContent content = random_content(random);
  const AtlasContent same = refined(content, storage_grid(content).size);
  EXPECT_EQ(same.class_volume, content.class_volume);
  EXPECT_EQ(same.values, content.values);
}

}  // namespace
}  // namespace splatlas

#include "format/derive/boundary_split.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "format/atlas_reader.h"
#include "format/atlas_writer.h"
#include "tests/format/atlas_surgery.h"
#include "tests/support/fill_classes.h"

namespace splatlas {
namespace {

/// Mostly covered, so that there is an interior.
std::vector<std::uint8_t> random_mask(const Index3& size) {
  auto mask = *rc::gen::container<std::vector<std::uint8_t>>(
      static_cast<std::size_t>(size[0] * size[1] * size[2]), rc::gen::inRange<std::uint8_t>(0, 40));
  for (std::uint8_t& m : mask) m = m != 0;
  return mask;
}

RC_GTEST_PROP(SplitBoundary, IsTheDefinitionAlongEveryAxis, ()) {
  Index3 size{*rc::gen::inRange<std::int64_t>(1, 9), *rc::gen::inRange<std::int64_t>(1, 9),
              *rc::gen::inRange<std::int64_t>(1, 9)};
  // Scanlines of several words along one axis or another.
  size[*rc::gen::inRange<std::size_t>(0, 3)] = *rc::gen::inRange<std::int64_t>(1, 200);
  const auto mask = random_mask(size);
  const std::vector<ClassId> parts = split_by_definition(mask, size);
  const std::vector<ClassId> whole(mask.begin(), mask.end());
  for (const Axis axis : kAxes) {
    const ClassRuns runs = encode_runs(whole, size, axis, 2).classes[1];
    const RunModel expected = encode_runs(parts, size, axis, 3);
    const SplitRuns split = split_boundary(runs, size, axis);
    RC_ASSERT(split.interior == expected.classes[1]);
    RC_ASSERT(split.boundary == expected.classes[2]);
    RC_ASSERT(join_runs(split.interior, split.boundary) == runs);
  }
}

TEST(FindSplitGroups, WantsAnInteriorAndABoundaryOfStructuresThatNoOtherGroupHolds) {
  const auto split = [](const std::vector<std::vector<Membership>>& classes) {
    ClassTable table;
    for (const auto& members : classes) table.intern(members);
    const ValueGroups groups(table);
    return find_split_groups(groups, table);
  };
  constexpr Part in = Part::kInterior, on = Part::kBoundary, crossed = Part::kCrossed;
  using Split = std::vector<bool>;  // [group]; group 0 is that of the empty class
  EXPECT_EQ(split({{{0, in}}, {{0, on}}}), (Split{false, true}));
  EXPECT_EQ(split({{{0, in}, {1, in}}, {{0, on}, {1, on}}}), (Split{false, true}));
  EXPECT_EQ(split({{{0, in}}, {{0, on}}, {{1, crossed}}}), (Split{false, true, false}));
  EXPECT_EQ(split({{{0, on}}}), (Split{false, false}));
  EXPECT_EQ(split({{{0, on}}, {{0, in}}}), (Split{false, false}));
  EXPECT_EQ(split({{{0, in}, {1, on}}, {{0, on}, {1, on}}}), (Split{false, false}));
  EXPECT_EQ(split({{{0, in}}, {{0, on}}, {{0, on}, {1, on}}}), (Split{false, false, false}));
}

/// A block of one structure with its derived boundary. `marked` belongs to the boundary, too.
AtlasContent block(const Index3& marked = {-1, -1, -1}) {
  AtlasContent content;
  content.source_grid.size = {8, 7, 6};
  content.graph = *StructureGraph::build({{.id = "block"}});
  const auto holds = [&](const Index3& at) {
    return content.source_grid.contains(at[0], at[1], at[2]) && at[0] > 0 && at[0] < 6 && at[1] > 1 &&
           at[2] > 0;
  };
  fill_classes(content, [&](const Index3& at) -> std::vector<Membership> {
    if (!holds(at)) return {};
    return {{0, is_boundary(at, holds) || at == marked ? Part::kBoundary : Part::kInterior}};
  });
  content.surfaces.resize(1);
  content.boundary_normals.resize(3);
  content.boundary_normals[2].resize(content.classes.voxels(2));
  return content;
}

TEST(SharedRuns, ABoundaryThatIsNoneHasAListOfItsOwn) {
  const AtlasContent content = block({3, 3, 3});
  ASSERT_EQ(content.classes.voxels(1), block().classes.voxels(1) - 1);
  const Bytes file = *encode_atlas(content);
  EXPECT_GT(take_apart(file).directory.run_bytes[2][2], 0u);
  const auto atlas = *Atlas::open_bytes(file);
  EXPECT_TRUE(atlas->verify().has_value());
  EXPECT_EQ(atlas->read_all()->class_volume, content.class_volume);
}

}  // namespace
}  // namespace splatlas

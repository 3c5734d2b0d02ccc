#include "preprocess/check/examine_atlas.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/fails_with.h"
#include "tests/support/test_content.h"

namespace splatlas {
namespace {

using testing::UnorderedElementsAreArray;

constexpr Index3 kSize{44, 24, 24};
constexpr double kSpacing = 2;  // mm; voxel (i, j, k) is at (2i, 2j, 2k)

/// Content of a finding, with the voxel of its place.
struct Told {
  std::string kind;
  std::vector<std::string> structures;
  std::size_t count;
  std::optional<Index3> voxel;
  friend bool operator==(const Told&, const Told&) = default;
  friend std::ostream& operator<<(std::ostream& out, const Told& told) {
    out << told.kind << ' ' << testing::PrintToString(told.structures) << ' ' << told.count;
    return told.voxel ? out << " at " << testing::PrintToString(*told.voxel) : out;
  }
};

std::vector<Told> told_by(const Examination& examination) {
  std::vector<Told> told;
  for (const Finding& f : examination.findings) {
    told.push_back({f.kind, f.structures, f.count, {}});
    if (!f.place_lps_mm) continue;
    told.back().voxel.emplace();
    for (std::size_t a = 0; a < 3; ++a)
      (*told.back().voxel)[a] = std::llround((*f.place_lps_mm)[a] / kSpacing);
    EXPECT_NE(f.remedy, "") << f.kind;
  }
  return told;
}

/// A volume of structures with colours of their own, and names and labels by `change`.
struct Planted {
  TestVolume volume;

  Planted() { volume.grid = {kSize, {kSpacing, kSpacing, kSpacing}}; }
  StructureIndex add(const std::string& id, const std::vector<bool>& mask,
                     std::vector<StructureIndex> parents = {}) {
    const std::size_t n = volume.structures.size();
    volume.structures.push_back({id, mask, default_color(n), std::move(parents)});
    return static_cast<StructureIndex>(n);
  }
  StructureIndex add_box(const std::string& id, const Index3& first, const Index3& last,
                         std::vector<StructureIndex> parents = {}) {
    return add(id, box_mask(kSize, first, last), std::move(parents));
  }
  template <typename Change>
  [[nodiscard]] Examination examine(const Change& change) const {
    AtlasContent content = make_content(volume);
    std::vector<Structure> structures(content.graph.structures().begin(), content.graph.structures().end());
    change(structures);
    content.graph = value_or_throw(StructureGraph::build(std::move(structures)));
    return value_or_throw(examine_atlas(*open_in_memory(content)));
  }
};

/// One voxel of `mask` changes.
void flip(std::vector<bool>& mask, const Index3& at) {
  const auto voxel = static_cast<std::size_t>((at[2] * kSize[1] + at[1]) * kSize[0] + at[0]);
  mask[voxel] = !mask[voxel];
}

TEST(ExamineAtlas, FindsEachPlantedFaultWithItsPlace) {
  Planted planted;
  const StructureIndex body = planted.add("Body", {});
  const std::vector<StructureIndex> in_body{body};
  // The sides of one pair are exchanged; two structures lie on the side that their names do not tell
  planted.add_box("Left_kidney", {2, 0, 0}, {4, 4, 4}, in_body);
  planted.add_box("Right_kidney", {38, 0, 0}, {40, 4, 4}, in_body);
  planted.add_box("lung_l", {36, 0, 6}, {40, 4, 10}, in_body);
  planted.add_box("lung_r", {2, 0, 6}, {6, 4, 10}, in_body);
  planted.add_box("Left_adrenal", {2, 0, 12}, {4, 2, 14}, in_body);
  planted.add_box("rh-rib", {38, 0, 12}, {40, 2, 14}, in_body);
  // Of the largest piece's 1000 voxels less one hole, 5 % are no stray piece
  std::vector<bool> spleen = box_mask(kSize, {10, 2, 2}, {19, 11, 11});
  for (const Index3& at : {Index3{10, 14, 2}, {11, 14, 2}, {10, 16, 2}, {14, 6, 6}}) flip(spleen, at);
  for (std::int64_t j = 13; j < 18; ++j)
    for (std::int64_t i = 0; i < 10; ++i) flip(spleen, {10 + i, j, 11});
  planted.add("Spleen", spleen, in_body);
  // Names, labels and codes
  const StructureIndex unnamed = planted.add_box("L7", {22, 0, 0}, {22, 0, 2}, in_body);
  const StructureIndex ghost = planted.add("Ghost", {}, in_body);
  const StructureIndex node_1 = planted.add_box("Node", {24, 0, 0}, {24, 0, 0}, in_body);
  const StructureIndex node_2 = planted.add_box("Node_2", {26, 0, 0}, {26, 0, 0}, in_body);
  const StructureIndex twice_1 = planted.add_box("T1", {28, 0, 0}, {28, 0, 0}, in_body);
  const StructureIndex twice_2 = planted.add_box("T2", {30, 0, 0}, {30, 0, 0}, in_body);
  const StructureIndex code_1 = planted.add_box("C1", {32, 0, 0}, {32, 0, 0}, in_body);
  const StructureIndex code_2 = planted.add_box("C2", {34, 0, 0}, {34, 0, 0}, in_body);
  // Neighbours
  planted.add_box("Aorta", {22, 4, 4}, {25, 7, 7}, in_body);
  const StructureIndex vein = planted.add_box("Vein", {26, 4, 4}, {29, 7, 7}, in_body);
  planted.volume.structures[vein].color = planted.volume.structures[vein - 1].color;
  planted.add_box("Liver", {22, 10, 4}, {25, 13, 7}, in_body);
  planted.add_box("Gallbladder", {25, 13, 7}, {27, 15, 9}, in_body);
  const StructureIndex screw = planted.add("Screw", {}, in_body);
  planted.volume.structures[screw].external.positions_ijk = {{42, 22, 22}, {42.25, 22, 22}, {42, 22.25, 22}};
  planted.volume.structures[screw].external.normals_lps.assign(3, {0, 0, 1});
  planted.volume.structures[screw].external.triangles = {{0, 1, 2}};
  planted.volume.structures[screw].external.position_scale = 4;
  // The tree
  planted.add("No_members", {}, in_body);
  const StructureIndex group = planted.add("One_member", {}, in_body);
  planted.add_box("Member", {36, 0, 0}, {36, 0, 0}, {group});
  const StructureIndex outside = planted.add_box("Outside", {36, 8, 0}, {36, 8, 0});

  const Examination examination = planted.examine([&](std::vector<Structure>& structures) {
    structures[unnamed].label = 7;
    structures[unnamed].name = "Label 7";
    structures[ghost].label = 8;
    structures[node_1].name = "Node";
    structures[node_2].name = "node";
    structures[twice_1].label = structures[twice_2].label = 9;
    structures[code_1].terms =
        structures[code_2].terms = {{"SNOMED", "64033007"}, {"synonym", "Part 1"}, {"la", "Pars 1"}};
    structures[outside].label = 10;
  });
  const std::vector<Told> expected{{"unnamed-labels", {"L7"}, 1, Index3{22, 0, 1}},
                                   {"empty-structures", {"Ghost"}, 1, {}},
                                   {"labels-twice", {"T1", "T2"}, 2, Index3{28, 0, 0}},
                                   {"codes-twice", {"C1", "C2"}, 2, Index3{32, 0, 0}},
                                   {"equal-names", {"Node", "Node_2"}, 2, Index3{24, 0, 0}},
                                   {"equal-colors", {"Aorta", "Vein"}, 2, Index3{26, 4, 4}},
                                   {"stray-pieces", {"Spleen"}, 2, Index3{10, 14, 2}},
                                   {"holes", {"Spleen"}, 1, Index3{14, 6, 6}},
                                   {"wrong-side", {"Left_kidney", "Right_kidney"}, 2, Index3{3, 2, 2}},
                                   {"wrong-side", {"Left_adrenal"}, 1, Index3{3, 1, 13}},
                                   {"wrong-side", {"rh-rib"}, 1, Index3{39, 1, 13}},
                                   {"overlaps", {"Liver", "Gallbladder"}, 1, Index3{25, 13, 7}},
                                   {"meshes-apart", {"Screw"}, 1, Index3{42, 22, 22}},
                                   {"empty-groups", {"No_members"}, 1, {}},
                                   {"single-members", {"One_member"}, 1, Index3{36, 0, 0}},
                                   {"outside-tree", {"Outside"}, 1, Index3{36, 8, 0}}};
  EXPECT_THAT(told_by(examination), UnorderedElementsAreArray(expected));

  const StructureRow& row = examination.rows[7];
  EXPECT_EQ(row.structure.id, "Spleen");
  EXPECT_EQ(row.measures.sums.voxels, 999u + 3 + 50);
  EXPECT_DOUBLE_EQ(row.ml, 8e-3 * (999 + 3 + 50));
  EXPECT_EQ(row.measures.pieces, 4u);
  EXPECT_EQ(row.measures.holes, 1u);
  EXPECT_EQ(row.box_lps_mm, std::pair(Vec3{19, 3, 3}, Vec3{39, 35, 23}));
}

/// Partners of one colour, nested structures, large cavities, surfaces around structures, equal names.
TEST(ExamineAtlas, FindsNothingInAnAtlasWithoutFaults) {
  Planted planted;
  const StructureIndex left = planted.add("Left", {}), right = planted.add("Right", {});
  planted.add_box("Lobe_1", {22, 0, 0}, {30, 8, 8}, {left});
  planted.add_box("Lobe_2", {13, 0, 0}, {21, 8, 8}, {right});
  const StructureIndex nucleus = planted.add_box("nucleus_left", {22, 10, 0}, {30, 20, 8}, {left});
  planted.add_box("nucleus_right", {13, 10, 0}, {21, 20, 8}, {right});
  planted.volume.structures[nucleus + 1].color = planted.volume.structures[nucleus].color;
  planted.add_box("Core", {24, 12, 2}, {28, 18, 6}, {left});
  std::vector<bool> skull = box_mask(kSize, {0, 0, 12}, {20, 20, 22});
  for (std::int64_t n = 0; n < 100; ++n) flip(skull, {5 + n % 10, 5 + n / 10, 15});
  planted.add("Vault", skull, {right});
  const StructureIndex box = planted.add("Box", {}, {left});
  planted.volume.structures[box].external.positions_ijk = {{22, 0, 0}, {22.25, 0, 0}, {22, 0.25, 0}};
  planted.volume.structures[box].external.normals_lps.assign(3, {0, 0, 1});
  planted.volume.structures[box].external.triangles = {{0, 1, 2}};
  planted.volume.structures[box].external.position_scale = 4;
  const Examination examination = planted.examine(
      [&](std::vector<Structure>& structures) { structures[2].name = structures[3].name = "Lobe"; });
  EXPECT_THAT(told_by(examination), IsEmpty());
  EXPECT_EQ(examination.rows[7].measures.holes, 1u);
  EXPECT_EQ(examination.rows[left].measures.sums.voxels, 9 * 9 * 9 + 9 * 11 * 9u);  // the core once
}

/// Boxes of 44 voxels of 4 mm, with a nose of 6 x 4 x 3 voxels.
TEST(ExamineAtlas, FindsTheFaceOfAHead) {
  Planted planted;
  std::vector<bool> mask = box_mask(kSize, {4, 6, 0}, {39, 23, 23});
  for (std::int64_t n = 0; n < 6 * 4 * 3; ++n) flip(mask, {20 + n % 6, 2 + n / 6 % 4, 8 + n / 24});
  planted.add("Head", mask);
  planted.volume.grid.spacing_mm = {4, 4, 4};
  const auto find = [&](const std::string& name) {
    return told_by(planted.examine([&](std::vector<Structure>& structures) { structures[0].name = name; }));
  };
  EXPECT_THAT(find("Head"), ElementsAre(Told{"faces", {}, 1, Index3{40, 4, 18}}));  // in voxels of 2 mm
  EXPECT_THAT(find("Head, outline"), testing::SizeIs(1));
  for (const char* const name : {"Trunk", "medial head gastrocnemius muscle", "Femoral head"})
    EXPECT_THAT(find(name), IsEmpty()) << name;
}

TEST(FindNose, NeedsTheRiseOfANoseInSlicesAsWideAsAHead) {
  const Grid grid{{44, 24, 24}, {4, 4, 4}};
  const auto find = [&](const Index3& head, const Index3& nose, const Index3& last) {
    std::vector<std::uint8_t> mask;
    const std::vector<bool> body = box_mask(kSize, head, {43 - head[0], 23, 23}),
                            front = box_mask(kSize, nose, last);
    for (std::size_t v = 0; v < body.size(); ++v) mask.push_back(body[v] || front[v] ? 1 : 0);
    return find_nose(mask, grid);
  };
  EXPECT_EQ(find({4, 6, 0}, {20, 3, 8}, {25, 5, 10}), (Index3{20, 3, 9}));
  EXPECT_EQ(find({4, 6, 0}, {20, 4, 8}, {25, 5, 10}), std::nullopt);   // 8 mm
  EXPECT_EQ(find({4, 6, 0}, {20, 3, 8}, {25, 5, 9}), std::nullopt);    // 8 mm high
  EXPECT_EQ(find({4, 6, 0}, {14, 3, 8}, {30, 5, 10}), std::nullopt);   // 68 mm wide: no nose
  EXPECT_EQ(find({12, 6, 0}, {20, 3, 8}, {25, 5, 10}), std::nullopt);  // a body 80 mm wide
  EXPECT_EQ(find({4, 6, 0}, {4, 6, 0}, {4, 6, 0}), std::nullopt);
}

}  // namespace
}  // namespace splatlas

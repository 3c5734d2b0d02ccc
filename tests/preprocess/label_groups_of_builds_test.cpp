// Builds of several label maps, of structures split at a plane or by an image, and of fragments and openings.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/preprocess/build_atlas_fixture.h"
#include "tests/preprocess/messages_of_notes.h"
#include "tests/preprocess/random_images.h"
#include "tests/support/fails_with.h"
#include "tests/support/file_bytes.h"

namespace splatlas {
namespace {

class LabelGroups : public BuildAtlas {
 protected:
  /// The path, label and voxels of each structure with voxels.
  std::vector<std::string> built(const BuildOptions& options) const {
    const AtlasContent content = build(options);
    std::vector<std::uint64_t> voxels(content.graph.size());
    for (ClassId c = 0; c < content.classes.size(); ++c) {
      for (const Membership& m : content.classes.members(c)) voxels[m.structure] += content.classes.voxels(c);
    }
    std::vector<std::string> lines;
    for (const StructureIndex s : content.graph.preorder()) {
      if (voxels[s] > 0)
        lines.push_back(
            fmt::format("{} #{}: {}", content.graph.paths(s).front(), *content.graph[s].label, voxels[s]));
    }
    return lines;
  }
  BuildOptions scene = options();
};

/// The map on the right is a part of the lattice of the other. Its structure 2 lies in the other's 1.
TEST_F(LabelGroups, ShareALatticeAndOverlap) {
  const auto left = [](auto i, auto j, auto k) { return i / 2 == 2 && j > 0 && j < 4 && k < 4 ? 1 : i > 6; };
  const auto right = [](auto i, auto j, auto k) { return j > 2 || k > 3 ? 0 : i < 2 ? 1 : 2 * (i == 3); };
  scene.sources.labels = write("left=.nrrd", byte_image({.size = {8, 5, 6}}, left));
  scene.sources.labels_group = "left";
  const Grid part{.size = {5, 4, 6}, .origin_lps_mm = {1, 1, 0}};
  scene.sources.more_labels = {parse_labels("right=" + write("right.nrrd", byte_image(part, right)))};
  EXPECT_THAT(built(scene),
              ElementsAre("left/Label 1 #1: 54", "right/Label 1 #1: 24", "right/Label 2 #2: 12"));
  write_bytes(file("names.csv"), "label,name,parent\n1,Cortex,Brain\n2,Node,Brain\n7,None,Brain\n");
  scene.sources.names = file("names.csv");  // the hierarchy stands below each group
  EXPECT_THAT(built(scene), ElementsAre("left/Brain/Cortex #1: 54", "right/Brain/Cortex #1: 24",
                                        "right/Brain/Node #2: 12"));
  write_bytes(file("paths.tree"), "Brain/left\nBrain/right\n");
  scene.sources.tree = file("paths.tree");
  const StructureGraph graph = build(scene).graph;
  EXPECT_EQ(graph.paths(graph.find("left/Cortex").value()[0])[0], "Brain/left/Cortex");
  EXPECT_EQ(graph[graph.find("right_Cortex").value()[0]].label, 1);
  EXPECT_THAT(graph.find("Cortex"), FailsWith(ErrorCode::kNotFound, HasSubstr("right/Cortex")));
  write_bytes(file("a.json"), R"([{"id":1,"name":"A","structure_id_path":[1]},{"id":1,"name":"B"}])");
  scene.sources.names = scene.sources.tree = file("a.json");  // is read twice, and told once
  Notes notes;
  ASSERT_TRUE(build_atlas(scene, notes));
  EXPECT_THAT(items_of(notes, "duplicate-labels"), ElementsAre("label 1 at a.json entry 2"));
}

TEST_F(LabelGroups, RefuseWhatDoesNotFit) {
  Image labels = byte_image({.size = {4, 3, 2}}, [](auto i, auto, auto) { return i; });
  scene.sources.labels = write("a=b.nrrd", labels);
  EXPECT_EQ(parse_labels(file("a=b.nrrd")).group, "");
  labels.grid.origin_lps_mm[0] = 0.5;
  scene.sources.more_labels = {{"b", write("b.nrrd", labels)}};
  EXPECT_THAT(error_of(scene), HasSubstr("a=b.nrrd\": one of several label maps must be NAME=FILE"));
  scene.sources.labels_group = "B";
  EXPECT_THAT(error_of(scene), HasSubstr("\"b\" is taken"));
  scene.sources.labels_group = "a";
  EXPECT_THAT(error_of(scene), HasSubstr("several label maps need voxels of one lattice"));
}

/// The ball of radius 8 has 2109 voxels, 197 of them at x = 0, which is left. Sides of 1 % are split.
TEST_F(LabelGroups, SplitAtAPlaneOrByAnImage) {
  const Grid grid{.size = {21, 21, 30}, .origin_lps_mm = {-10, 0, 0}};
  scene.sources.labels = write("labels.nrrd", byte_image(grid, [](auto i, auto j, auto k) {
                                 const auto x = i - 10, y = j - 10, z = k - 10;
                                 if (x * x + y * y + z * z <= 64) return 1;
                                 const bool is_left = x >= 0 && x < 10 && j < 10,
                                            is_right = x == -1 && j == 3;
                                 if (k == 22) return (is_left && i + j > 10) || is_right ? 2 : 0;
                                 if (k == 24) return is_left || is_right ? 3 : 0;
                                 return k == 26 && j == 0 && x < -5 ? 4 : 0;
                               }));
  std::vector<std::string> expected{"Label 1/Label 1 left #1: 1153",
                                    "Label 1/Label 1 right #1: 956",
                                    "Label 2/Label 2 left #2: 99",
                                    "Label 2/Label 2 right #2: 1",
                                    "Label 3 #3: 101",
                                    "Label 4 #4: 5"};
  scene.sources.sides = "x=0";
  EXPECT_EQ(built(scene), expected);
  const auto atlas = value_or_throw(Atlas::open(scene.output));
  const auto color_of = [&](const char* name) {
    return atlas->graph()[atlas->graph().find(name)->front()].color;
  };
  EXPECT_EQ(color_of("Label 1 left"), color_of("Label 1"));
  const auto write_sides = [&](const auto& side) {
    return write("sides.nrrd", in_order(byte_image(grid, side), AxisOrder{{2, 0, 1}, {true, false, true}}));
  };
  scene.sources.sides = write_sides([](auto i, auto j, auto k) {  // a voxel of the ball is on no side
    return i == 10 && j == 10 && k == 10 ? 0 : i >= 10 ? 1 : 2;
  });
  expected[0] = "Label 1/Label 1 left #1: 1152";
  expected.insert(expected.begin(), "Label 1 #1: 1");
  EXPECT_EQ(built(scene), expected);
  std::filesystem::remove(scene.output);
  write_sides([](auto...) { return 3; });
  EXPECT_THAT(error_of(scene), HasSubstr("holds the value 3; the sides are 1 (left) and 2 (right)"));
  write_sides([](auto...) { return 1; });
  EXPECT_THAT(error_of(scene), HasSubstr("has no voxel of 2"));
  scene.sources.sides = "x=left";
  EXPECT_THAT(error_of(scene), HasSubstr("--sides \"x=left\": must be x=MM"));
  scene.sources.sides = "x=-10.5";
  EXPECT_EQ(items_of(build_atlas(scene)->notes, "sides-unused"), std::vector<std::string>{"x=-10.5"});
}

const Grid kFragmentGrid{.size = {12, 8, 8}};

/// Voxels of each structure of `content`, by name.
std::uint64_t voxels_of(const AtlasContent& content, const std::string& name) {
  std::uint64_t voxels = 0;
  for (ClassId c = 0; c < content.classes.size(); ++c) {
    for (const Membership& member : content.classes.members(c)) {
      if (content.graph[member.structure].name == name) voxels += content.classes.voxels(c);
    }
  }
  return voxels;
}

/// Label 1: a block of 200 voxels, and one beside it. The rest is the mask of a segment: 8 voxels apart.
class FragmentsOfBuilds : public BuildAtlas {
 protected:
  BuildOptions scene() const {
    BuildOptions build = options();
    build.sources.labels = write("labels.nrrd", byte_image(kFragmentGrid, [](auto i, auto j, auto k) {
                                   return (i < 5 && j < 5) || (i == 7 && j == 7 && k == 7);
                                 }));
    const std::string mask = write("mask.nrrd", byte_image(kFragmentGrid, [](auto i, auto j, auto) {
                                     return (i < 8 && j < 5) || (i == 11 && j == 0) || j == 7;
                                   }));
    build.sources.segments = {*parse_segment("Rest=mask:" + mask)};
    return build;
  }
  std::vector<std::string> notes_of(const BuildOptions& options) const {
    const Result<BuildReport> report = build_atlas(options);
    EXPECT_TRUE(report) << report.error().message;
    return report ? messages_of(report->notes) : std::vector<std::string>();
  }
};

TEST_F(FragmentsOfBuilds, AreReportedOnce) {
  EXPECT_THAT(
      notes_of(scene()),
      ElementsAre(AllOf(HasSubstr("3 fragments with 104 voxels in 2 structures: \"Rest\" (2 with 103), "
                                  "\"Label 1\" (1 with 1)"),
                        HasSubstr("--drop-fragments 100"))));
}

/// 8 x 5 x 8 and 12 x 8 voxels of the mask, and 8 apart; the labels keep all of theirs.
TEST_F(FragmentsOfBuilds, MasksMayOverlapLabels) {
  BuildOptions build = scene();
  build.sources.segments[0].overlaps = true;
  const AtlasContent content = this->build(build);
  EXPECT_EQ(voxels_of(content, "Rest"), 8u * 5 * 8 + 12 * 8 + 8);
  EXPECT_EQ(voxels_of(content, "Label 1"), 201u);
}

TEST_F(FragmentsOfBuilds, OfLabelsMayGetIntoSegments) {
  BuildOptions build = scene();
  build.fragments = {*parse_fragments("9")};
  EXPECT_THAT(notes_of(build), ElementsAre(HasSubstr("dropped 2 fragments with 9 voxels in 2 structures")));
  const AtlasContent content = this->build(build);
  EXPECT_EQ(voxels_of(content, "Label 1"), 200u);
  EXPECT_EQ(voxels_of(content, "Rest"), 3u * 5 * 8 + 12 * 8);
}

TEST_F(FragmentsOfBuilds, NamedRulesComeFirst) {
  BuildOptions build = scene();
  build.fragments = {*parse_fragments(" REST = 0"), *parse_fragments("100")};
  EXPECT_THAT(notes_of(build), ElementsAre(HasSubstr("\"Label 1\" (1 with 1)")));
  EXPECT_EQ(voxels_of(this->build(build), "Rest"), 3u * 5 * 8 + 12 * 8 + 8);
  build.fragments = {*parse_fragments("0")};
  EXPECT_THAT(notes_of(build), IsEmpty());
  build.fragments = {*parse_fragments("Nobody=3")};
  EXPECT_THAT(build_atlas(build), FailsWith(ErrorCode::kUsage, HasSubstr("\"Nobody\"")));
}

TEST_F(FragmentsOfBuilds, OpeningRemovesThinParts) {
  BuildOptions build = scene();
  build.sources.segments[0].open_mm = 1;
  build.fragments = {*parse_fragments("0")};
  // A ball of one voxel holds the neighbours that share a face or an edge: the block of 3 x 5 x 8 voxels
  // beside the label keeps its edges. The column and the plate are one voxel thick.
  EXPECT_EQ(voxels_of(this->build(build), "Rest"), 3u * 5 * 8);
}

TEST(ParseFragments, ReadsRules) {
  EXPECT_EQ(parse_fragments("12")->below, 12u);
  EXPECT_EQ(parse_fragments("12")->name, "");
  EXPECT_EQ(parse_fragments("a=b=3")->name, "a=b");
  for (const char* wrong : {"", "x", "-1", "=3", "a=", "a=x", "1.5", "99999999999999", "nan"}) {
    EXPECT_THAT(parse_fragments(wrong), FailsWith(ErrorCode::kUsage, HasSubstr("NAME=N"))) << wrong;
  }
}

}  // namespace
}  // namespace splatlas

// Fragments and openings in whole builds.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/preprocess/build_atlas_fixture.h"
#include "tests/preprocess/messages_of_notes.h"
#include "tests/preprocess/random_images.h"

namespace splatlas {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const Grid kGrid{.size = {12, 8, 8}};

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

/// Label 1: a block of 200 voxels, and one voxel beside it. The rest is the mask of a segment: 8 voxels
/// apart.
class FragmentsOfBuilds : public BuildAtlas {
 protected:
  BuildOptions scene() const {
    BuildOptions build = options();
    build.sources.labels = write("labels.nrrd", byte_image(kGrid, [](auto i, auto j, auto k) {
                                   return (i < 5 && j < 5) || (i == 7 && j == 7 && k == 7);
                                 }));
    const std::string mask = write("mask.nrrd", byte_image(kGrid, [](auto i, auto j, auto) {
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
  const Result<BuildReport> refused = build_atlas(build);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kUsage);
  EXPECT_THAT(refused.error().message, HasSubstr("\"Nobody\""));
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
    const auto rule = parse_fragments(wrong);
    ASSERT_FALSE(rule) << wrong;
    EXPECT_EQ(rule.error().code, ErrorCode::kUsage);
    EXPECT_THAT(rule.error().message, HasSubstr("NAME=N"));
  }
}

}  // namespace
}  // namespace splatlas

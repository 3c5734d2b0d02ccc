#include "preprocess/export/export_labels.h"

#include <limits>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "format/derive/label_map.h"
#include "preprocess/export/write_image.h"
#include "preprocess/import/labels/import_labels.h"
#include "preprocess/import/tables/text_file.h"
#include "tests/preprocess/random_images.h"
#include "tests/support/axis_orders.h"
#include "tests/support/committed.h"
#include "tests/support/fails_with.h"
#include "tests/support/fill_classes.h"
#include "tests/support/temporary_folder.h"

namespace splatlas {
namespace {

/// One structure with this label in the first voxel of a row of three.
AtlasContent labelled_voxel(VoxelType type, std::int64_t label) {
  AtlasContent content;
  content.source_grid.size = {3, 1, 1};
  content.graph = StructureGraph::build({{.id = "one", .name = "One", .label = label}}).value();
  content.label_type = type;
  fill_classes(content, [](const Index3& at) {
    return at[0] == 0 ? std::vector<Membership>{{0, Part::kBoundary}} : std::vector<Membership>{};
  });
  return content;
}

TEST(ExportLabels, ListTheStructuresThatALabelMapLeavesOut) {
  AtlasContent content;
  content.source_grid.size = {3, 1, 1};
  content.graph = StructureGraph::build({{.id = "group", .name = "Group"},
                                         {.id = "one", .name = "One", .label = 7},
                                         {.id = "segment", .name = "Segment", .parents = {0}}})
                      .value();
  fill_classes(content, [](const Index3& at) {
    return std::vector<Membership>{{at[0] == 0 ? 1u : 2u, Part::kBoundary}};
  });
  EXPECT_THAT(structures_without_label(content), ElementsAre("Segment"));
}

/// A label map, written and read again.
VoxelBuffer through_a_file(const AtlasContent& content, const VoxelBuffer& labels) {
  const TemporaryFolder folder;
  EXPECT_TRUE(committed(write_image({content.source_grid, labels}, folder.file("labels.nrrd"))));
  return import_image(folder.file("labels.nrrd")).value().voxels;
}

struct Label {
  VoxelType type;
  std::int64_t label;
};

TEST(ExportLabels, WritesTheExtremeLabelsOfEachType) {
  for (const Label& extreme : {Label{VoxelType::kUInt8, 255},
                               {VoxelType::kInt8, -128},
                               {VoxelType::kUInt16, 65535},
                               {VoxelType::kInt16, -32768},
                               {VoxelType::kUInt32, 4294967295},
                               {VoxelType::kInt32, -2147483648},
                               {VoxelType::kFloat32, 16777216},
                               {VoxelType::kFloat64, 4294967295}}) {
    const auto content = labelled_voxel(extreme.type, extreme.label);
    const auto labels = value_or_throw(label_map(content, "A", "remedy"));
    const VoxelBuffer back = through_a_file(content, labels);
    visit_voxel_type(extreme.type, [&]<typename T>(T) {
      EXPECT_EQ(static_cast<std::int64_t>(back.as<T>()[0]), extreme.label) << name_of(extreme.type);
      EXPECT_EQ(back.as<T>()[1], T{0});
    });
  }
}

TEST(ExportLabels, RefusesLabelsThatTheTypeCannotHold) {
  for (const auto& [type, label] : {Label{VoxelType::kUInt8, 256},
                                    {VoxelType::kUInt8, -1},
                                    {VoxelType::kInt8, 128},
                                    {VoxelType::kUInt16, 65536},
                                    {VoxelType::kInt16, -32769},
                                    {VoxelType::kUInt32, 4294967296},
                                    {VoxelType::kInt32, 2147483648},
                                    {VoxelType::kFloat32, 16777217},
                                    {VoxelType::kFloat32, std::numeric_limits<std::int64_t>::max()},
                                    {VoxelType::kFloat64, 9007199254740993},
                                    {VoxelType::kFloat64, std::numeric_limits<std::int64_t>::max()}}) {
    EXPECT_THAT(
        label_map(labelled_voxel(type, label), "A", "export masks"),
        FailsWith(ErrorCode::kFailed, fmt::format("A: 'One' has label {}, which {} cannot hold; export masks",
                                                  label, name_of(type))));
  }
}

TEST(ExportLabels, StructuresWithoutVoxelsNeedNoPlaceInTheLabelMap) {
  AtlasContent content = labelled_voxel(VoxelType::kUInt8, 7);
  content.graph = StructureGraph::build({{.id = "one", .label = 7}, {.id = "two", .label = 300}}).value();
  content.classes.intern({{0, Part::kBoundary}, {1, Part::kBoundary}});
  content.classes.intern({{1, Part::kBoundary}});
  const auto labels = value_or_throw(label_map(content, "A", "remedy"));
  EXPECT_EQ(through_a_file(content, labels).bytes, (std::vector{std::byte{7}, std::byte{0}, std::byte{0}}));
}

TEST(ExportMasks, WritesNrrdFilesOfGridsThatNiftiCannotHold) {
  AtlasContent content = labelled_voxel(VoxelType::kNone, 7);
  const TemporaryFolder folder;
  const ExportedMasks straight = export_masks(content, folder.path() / "straight").value();
  EXPECT_EQ(straight.count, 1u);
  EXPECT_TRUE(straight.notes.empty());
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "straight" / "one.nii.gz"));

  content.source_grid.spacing_mm = {0.001, 0.001, 0.001};
  content.source_grid.origin_lps_mm = {1e6 + 1.0 / 3, 0, 0};  // floats are 0.06 mm apart
  content.graph = StructureGraph::build({{.id = "-one"}}).value();
  const std::filesystem::path path = folder.path() / "far";
  const ExportedMasks far = export_masks(content, path).value();
  EXPECT_EQ(far.count, 1u);
  EXPECT_THAT(
      far.notes,
      ElementsAre(path.string() + ": .nii.gz files cannot hold the atlas's grid; the masks are .nrrd files",
                  path.string() + ": 1 of the ids are no safe file names; their files have \"_\" in them"));
  const Image mask = import_image(path / "_-one.nrrd").value();
  EXPECT_EQ(mask.grid, content.source_grid);
  EXPECT_EQ(mask.voxels.bytes, (std::vector{std::byte{1}, std::byte{0}, std::byte{0}}));
}

TEST(ExportMasks, OfTheLongestIdsBuildBack) {
  AtlasContent content = labelled_voxel(VoxelType::kNone, 7);
  const std::string longest(240, 'x');
  content.graph = StructureGraph::build({{.id = longest}}).value();
  const TemporaryFolder folder;
  const ExportedMasks masks = export_masks(content, folder.path() / "masks").value();
  EXPECT_THAT(masks.notes, ElementsAre(testing::HasSubstr("1 of the ids are no safe file names")));
  const ImportedLabels back = value_or_throw(import_mask_folder(folder.path() / "masks"));
  ASSERT_EQ(back.structures.size(), 1u);
  EXPECT_EQ(back.structures[0].name, longest.substr(0, kMaxNameCharacters));
}

/// Structures at both ends, in the middle, everywhere and nowhere, in every axis order.
TEST(ExportMasks, HoldTheVoxelsOfTheirStructureAlone) {
  const std::vector<Structure> structures{{.id = "first"}, {.id = "last"}, {.id = "both"}, {.id = "none"}};
  const auto holds = [](StructureIndex s, const Index3& at) {
    const bool first = at == Index3{0, 0, 0}, last = at == Index3{2, 3, 4};
    return s == 0 ? first : s == 1 ? last : s == 2 && (first || last);
  };
  for (const AxisOrder& order : all_axis_orders()) {
    AtlasContent content;
    content.graph = StructureGraph::build(structures).value();
    content.source_grid = reordered({.size = {3, 4, 5}, .spacing_mm = {1, 2, 3}}, inverse(order));
    content.source_to_storage = storage_order(content.source_grid);
    fill_classes(content, [&](const Index3& at) {
      std::vector<Membership> members;
      for (StructureIndex s = 0; s < structures.size(); ++s) {
        if (holds(s, at)) members.push_back({s, Part::kBoundary});
      }
      return members;
    });
    const TemporaryFolder folder;
    ASSERT_TRUE(export_masks(content, folder.path() / "masks"));
    for (StructureIndex s = 0; s < structures.size(); ++s) {
      Image mask = import_image(folder.path() / "masks" / (structures[s].id + ".nii.gz")).value();
      const VoxelBuffer stored = to_storage_order(std::move(mask.voxels), mask.grid);
      std::int64_t v = 0;
      for (std::int64_t k = 0; k < 5; ++k) {
        for (std::int64_t j = 0; j < 4; ++j) {
          for (std::int64_t i = 0; i < 3; ++i, ++v)
            ASSERT_EQ(stored.as<std::uint8_t>()[v] != 0, holds(s, {i, j, k})) << structures[s].id << v;
        }
      }
    }
  }
}

}  // namespace
}  // namespace splatlas

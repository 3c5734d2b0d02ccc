#include "preprocess/import/labels/import_labels.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "preprocess/export/write_image.h"
#include "tests/preprocess/messages_of_notes.h"
#include "tests/preprocess/random_images.h"
#include "tests/preprocess/raw_image_files.h"
#include "tests/support/committed.h"
#include "tests/support/fails_with.h"
#include "tests/support/run_program.h"

namespace splatlas {
namespace {

template <typename T>
Image row(VoxelType type, const std::vector<T>& values) {
  Image image = zeros({.size = {std::ssize(values), 1, 1}}, type);
  std::ranges::copy(values, image.voxels.as<T>());
  return image;
}

SourceImage source(Image image) {
  SourceImage result;
  result.grid = image.grid;
  result.voxels = std::move(image.voxels);
  return result;
}

template <typename T>
Result<ImportedLabels> read_row(VoxelType type, const std::vector<T>& values, const std::string& name) {
  return read_label_map(source(row<T>(type, values)), name);
}

std::vector<std::string> names_of(const ImportedLabels& labels) {
  std::vector<std::string> names;
  for (const SourceStructure& s : labels.structures) names.push_back(s.name);
  return names;
}

/// The single structure of a voxel; -1 for none.
int holder(const ImportedLabels& labels, std::size_t voxel) {
  const auto& set = labels.memberships.sets()[labels.memberships.voxels()[voxel]];
  return set.empty() ? -1 : static_cast<int>(set.front());
}

TEST(ImportLabels, StructuresAreLabelsInOrder) {
  const auto labels =
      value_or_throw(read_row<std::uint16_t>(VoxelType::kUInt16, {700, 0, 7, 7, 65535, 700}, "a.nii"));
  EXPECT_THAT(names_of(labels), testing::ElementsAre("Label 7", "Label 700", "Label 65535"));
  const std::vector<int> expected{1, -1, 0, 0, 2, 1};
  for (std::size_t v = 0; v < 6; ++v) EXPECT_EQ(holder(labels, v), expected[v]);
  EXPECT_TRUE(labels.memberships.disjoint());
  EXPECT_EQ(labels.type, VoxelType::kUInt16);
}

TEST(ImportLabels, LabelsReach32Bits) {
  const auto integers = value_or_throw(read_row<std::uint32_t>(VoxelType::kUInt32, {0, 4294967295u}, "a"));
  EXPECT_EQ(integers.structures[0].label, 4294967295);
  const auto doubles = value_or_throw(read_row<double>(VoxelType::kFloat64, {-0.0, 4294967295.0}, "a"));
  EXPECT_EQ(doubles.structures[0].label, 4294967295);
  EXPECT_EQ(holder(doubles, 0), -1);
}

TEST(ImportLabels, RefusesWhatIsNoLabelWithItsValue) {
  EXPECT_THAT(read_row<std::int16_t>(VoxelType::kInt16, {0, -3}, "a.nii").error().message,
              AllOf(HasSubstr("a.nii"), HasSubstr("-3")));
  EXPECT_THAT(read_row<float>(VoxelType::kFloat32, {0, 1.5f}, "a").error().message, HasSubstr("1.5"));
  EXPECT_THAT(read_row<float>(VoxelType::kFloat32, {1.002f}, "a").error().message, HasSubstr("1.002"));
  EXPECT_FALSE(read_row<double>(VoxelType::kFloat64, {4294967296.0}, "a"));
}

TEST(ImportLabels, RoundsAndTakesNanForBackground) {
  const auto labels =
      read_row<float>(VoxelType::kFloat32, {1.000001f, std::nanf(""), 2.9995f, -1e-4f, -INFINITY}, "a");
  ASSERT_TRUE(labels) << labels.error().message;
  EXPECT_THAT(names_of(*labels), testing::ElementsAre("Label 1", "Label 3"));
  EXPECT_EQ(holder(*labels, 1), -1);
  EXPECT_EQ(holder(*labels, 2), 1);
  EXPECT_THAT(items_of(labels->notes, "rounded-labels"), testing::ElementsAre("a (by at most 0.0005)"));
  EXPECT_THAT(items_of(labels->notes, "nan-voxels"), testing::ElementsAre("a (2)"));
  const auto large = read_row<float>(VoxelType::kFloat32, {16777218.0f}, "a");
  EXPECT_THAT(items_of(large->notes, "inexact-labels"), testing::ElementsAre("a"));
  const auto any = read_label_map(source(row<float>(VoxelType::kFloat32, {1.4f, 7.5f})), "a", true);
  EXPECT_THAT(names_of(any.value()), testing::ElementsAre("Label 1", "Label 8"));
}

TEST(ImportLabels, BackgroundAloneIsANote) {
  const auto labels = value_or_throw(read_row<std::uint8_t>(VoxelType::kUInt8, {0, 0}, "a.nii"));
  EXPECT_TRUE(labels.structures.empty());
  EXPECT_THAT(messages_of(labels.notes), testing::ElementsAre("1 label map holds background only: a.nii"));
}

NamesTable table(std::vector<LabelName> names) {
  NamesTable result;
  result.names = std::move(names);
  return result;
}

LabelName name(std::int64_t label, const std::string& text) {
  LabelName structure;
  structure.name = text;
  structure.label = label;
  return structure;
}

TEST(NameLabels, CountsWhatDoesNotFit) {
  const auto labels = value_or_throw(read_row<std::uint8_t>(VoxelType::kUInt8, {1, 2, 3}, "a.nii"));
  ImportedLabels named = labels;
  EXPECT_TRUE(name_labels(named, table({name(2, "two"), name(1, "one"), name(3, "three")}), false));
  EXPECT_THAT(names_of(named), testing::ElementsAre("one", "two", "three"));
  EXPECT_TRUE(named.notes.empty());

  named = labels;
  EXPECT_TRUE(name_labels(named, table({name(1, "one"), name(9, "nine"), name(8, "eight")}), false));
  EXPECT_THAT(names_of(named), testing::ElementsAre("one", "Label 2", "Label 3"));
  EXPECT_THAT(messages_of(named.notes),
              testing::ElementsAre("2 names have no voxels and are dropped: nine (9), eight (8)",
                                   "2 labels have no names and are called \"Label N\": 2, 3"));
  named = labels;
  EXPECT_TRUE(name_labels(named, table({name(1, "one"), name(9, "nine"), name(8, "eight")}), true));
  EXPECT_THAT(names_of(named), testing::ElementsAre("one", "Label 2", "Label 3", "eight", "nine"));
  EXPECT_EQ(named.structures[4].label, 9);
}

TEST(NameLabels, RefusesNamesOfWhichNoneFits) {
  ImportedLabels labels = *read_row<std::uint8_t>(VoxelType::kUInt8, {1, 2, 3, 4}, "a.nii");
  EXPECT_THAT(
      name_labels(labels, table({name(9, "nine"), name(8, "eight")}), false).error().message,
      HasSubstr("the first is nine (9), and the first structure is Label 1 (1); give the table of these"));
  ImportedLabels segments;
  segments.structures.emplace_back().name = "Liver";
  EXPECT_THAT(name_labels(segments, table({name(1, "one")}), false).error().message,
              HasSubstr("the first structure is Liver; masks and overlapping segments have no labels"));
  EXPECT_TRUE(name_labels(segments, NamesTable(), false));
  NamesTable unlabelled = table({name(9, "nine")});
  unlabelled.columns = {"Weight", "Region"};
  EXPECT_THAT(name_labels(labels, unlabelled, false).error().message,
              HasSubstr("no column of labels was found in Weight, Region; call it \"label\""));
}

/// Rows that count from 0 name every label wrongly.
TEST(NameLabels, WarnsOfTablesThatCountFromZero) {
  ImportedLabels labels = *read_row<std::uint8_t>(VoxelType::kUInt8, {1, 2}, "a.nii");
  NamesTable from_zero = table({name(1, "heart")});
  for (const auto& [zero, warnings] : {std::pair("liver", 1u), {"Clear Label", 0u}}) {
    ImportedLabels named = labels;
    from_zero.zero_name = zero;
    EXPECT_TRUE(name_labels(named, from_zero, false));
    EXPECT_EQ(items_of(named.notes, "counts-from-0").size(), warnings);
  }
}

/// Masks, and labels that a header names, take colours and codes by their names.
TEST(NameLabels, FindsStructuresByName) {
  ImportedLabels named = *read_row<std::uint8_t>(VoxelType::kUInt8, {1, 2, 2}, "a.nii");
  named.structures[0].name = "Spleen";
  LabelName spleen = name(77, "spleen");
  spleen.color = Rgb{1, 2, 3};
  EXPECT_TRUE(name_labels(named, table({spleen}), false));
  EXPECT_EQ(named.structures[0].color, (Rgb{1, 2, 3}));
  EXPECT_EQ(named.structures[0].label, 1);
  EXPECT_THAT(messages_of(named.notes),
              testing::ElementsAre("1 label has no name and is called \"Label N\": 2"));
}

/// Masks have the ids of their structures as file names; exported tables have these as keys.
TEST(NameLabels, FindsMasksByTheirKey) {
  ImportedLabels named;
  named.structures.emplace_back().name = "right_lung";
  LabelName lung;
  lung.name = "Right lung";
  lung.key = "right_lung";
  EXPECT_TRUE(name_labels(named, table({lung}), false));
  EXPECT_EQ(named.structures[0].name, "Right lung");
  EXPECT_TRUE(named.notes.empty());
}

/// 64 values in blocks of a few voxels are labels; in a ramp they are grey values.
TEST(ImportLabels, RecognisesGreyValues) {
  std::vector<std::uint8_t> ramp, blocks;
  for (std::size_t n = 0; n < 512; ++n) {
    ramp.push_back(static_cast<std::uint8_t>(1 + n % 64));
    blocks.push_back(static_cast<std::uint8_t>(1 + n / 2 % 64));
  }
  ImportedLabels grey = read_row<std::uint8_t>(VoxelType::kUInt8, ramp, "t1.nii").value();
  EXPECT_THAT(check_doubt(grey).error().message, AllOf(HasSubstr("t1.nii: looks like grey values"),
                                                       HasSubstr("64 values in"), HasSubstr("--volume")));
  for (SourceStructure& structure : grey.structures) structure.name = "contact";
  EXPECT_TRUE(check_doubt(grey));
  EXPECT_TRUE(
      check_doubt(*read_label_map(source(row<std::uint8_t>(VoxelType::kUInt8, ramp)), "t1.nii", true)));
  EXPECT_TRUE(check_doubt(*read_row<std::uint8_t>(VoxelType::kUInt8, blocks, "aal.nii")));
}

TEST(ImportMasks, RefusesFoldersThatAreNoMasks) {
  const TemporaryFolder folder;
  EXPECT_THAT(import_mask_folder(folder.path()).error().message, HasSubstr("holds no mask"));
  ASSERT_TRUE(
      committed(write_image(row<std::uint8_t>(VoxelType::kUInt8, {0, 1}), folder.file("liver.nii.gz"))));
  ASSERT_TRUE(
      committed(write_image(row<std::uint8_t>(VoxelType::kUInt8, {0, 1}), folder.file("liver.nrrd"))));
  EXPECT_THAT(import_mask_folder(folder.path()).error().message, HasSubstr("same structure"));
  std::filesystem::rename(folder.file("liver.nrrd"), folder.file("LIVER.nrrd"));
  EXPECT_THAT(import_mask_folder(folder.path()).error().message, HasSubstr("same structure"));
  std::filesystem::rename(folder.file("LIVER.nrrd"), folder.file("li\tver.nrrd"));
  EXPECT_THAT(import_mask_folder(folder.path()).error().message, HasSubstr("a tab"));
  std::filesystem::remove(folder.file("li\tver.nrrd"));
  Image spleen = row<std::uint8_t>(VoxelType::kUInt8, {0, 1, 1});
  ASSERT_TRUE(committed(write_image(spleen, folder.file("spleen.nrrd"))));
  const auto both = import_mask_folder(folder.path());  // one lattice: the larger grid
  ASSERT_TRUE(both) << both.error().message;
  EXPECT_TRUE(both->resampled.empty());
  EXPECT_EQ(both->memberships.voxels().size(), 3u);
  spleen.grid.origin_lps_mm[0] += 0.25 * spleen.grid.spacing_mm[0];
  ASSERT_TRUE(committed(write_image(spleen, folder.file("spleen.nrrd"))));
  const auto resampled = import_mask_folder(folder.path());
  ASSERT_TRUE(resampled) << resampled.error().message;
  ASSERT_EQ(resampled->resampled.size(), 1u);
  EXPECT_EQ(resampled->resampled[0].name, "spleen");
  EXPECT_EQ(resampled->resampled[0].voxels_before, 2u);
  EXPECT_EQ(resampled->resampled[0].voxels_after, 1u);
}

TEST(ImportMasks, WhatIsNotZeroIsInside) {
  const TemporaryFolder folder;
  ASSERT_TRUE(
      committed(write_image(row<float>(VoxelType::kFloat32, {0, 1, 0.5f, 255}), folder.file("liver.nrrd"))));
  const auto masks = value_or_throw(import_mask_folder(folder.path()));
  EXPECT_EQ(holder(masks, 0), -1);
  for (std::size_t v = 1; v < 4; ++v) EXPECT_EQ(holder(masks, v), 0);
  EXPECT_THAT(messages_of(masks.notes),
              testing::ElementsAre("1 mask has several values; all but 0 are inside: liver"));
  ASSERT_TRUE(committed(
      write_image(row<float>(VoxelType::kFloat32, {0, 255, std::nanf(""), 255}), folder.file("liver.nrrd"))));
  EXPECT_TRUE(import_mask_folder(folder.path())->notes.empty());
  EXPECT_EQ(mask_of(row<float>(VoxelType::kFloat32, {std::nanf(""), 1}).voxels),
            (std::vector<std::uint8_t>{0, 1}));
}

}  // namespace
}  // namespace splatlas

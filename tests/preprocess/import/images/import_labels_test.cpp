#include "preprocess/import/images/import_labels.h"

#include <cmath>
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "preprocess/export/write_image.h"
#include "tests/preprocess/random_images.h"
#include "tests/preprocess/raw_image_files.h"
#include "tests/support/run_program.h"

namespace splatlas {
namespace {

using testing::AllOf;
using testing::HasSubstr;

template <typename T>
Image row(VoxelType type, const std::vector<T>& values) {
  Image image = zeros({.size = {std::ssize(values), 1, 1}}, type);
  std::ranges::copy(values, image.voxels.as<T>());
  return image;
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
      read_label_map(row<std::uint16_t>(VoxelType::kUInt16, {700, 0, 7, 7, 65535, 700}), "a.nii");
  ASSERT_TRUE(labels) << labels.error().message;
  EXPECT_THAT(names_of(*labels), testing::ElementsAre("Label 7", "Label 700", "Label 65535"));
  const std::vector<int> expected{1, -1, 0, 0, 2, 1};
  for (std::size_t v = 0; v < 6; ++v) EXPECT_EQ(holder(*labels, v), expected[v]);
  EXPECT_TRUE(labels->memberships.disjoint());
  EXPECT_EQ(labels->type, VoxelType::kUInt16);
}

TEST(ImportLabels, LabelsReach32Bits) {
  const auto integers = read_label_map(row<std::uint32_t>(VoxelType::kUInt32, {0, 4294967295u}), "a");
  ASSERT_TRUE(integers);
  EXPECT_EQ(integers->structures[0].label, 4294967295);
  const auto doubles = read_label_map(row<double>(VoxelType::kFloat64, {-0.0, 4294967295.0}), "a");
  ASSERT_TRUE(doubles);
  EXPECT_EQ(doubles->structures[0].label, 4294967295);
  EXPECT_EQ(holder(*doubles, 0), -1);
}

TEST(ImportLabels, RefusesWhatIsNoLabelWithItsValue) {
  EXPECT_THAT(read_label_map(row<std::int16_t>(VoxelType::kInt16, {0, -3}), "a.nii").error().message,
              AllOf(HasSubstr("a.nii"), HasSubstr("-3")));
  EXPECT_THAT(read_label_map(row<float>(VoxelType::kFloat32, {0, 1.5f}), "a").error().message,
              HasSubstr("1.5"));
  EXPECT_THAT(read_label_map(row<float>(VoxelType::kFloat32, {0, std::nanf("")}), "a").error().message,
              HasSubstr("nan"));
  EXPECT_THAT(read_label_map(row<float>(VoxelType::kFloat32, {INFINITY}), "a").error().message,
              HasSubstr("inf"));
  EXPECT_FALSE(read_label_map(row<double>(VoxelType::kFloat64, {4294967296.0}), "a"));
}

TEST(ImportLabels, BackgroundAloneIsANote) {
  const auto labels = read_label_map(row<std::uint8_t>(VoxelType::kUInt8, {0, 0}), "a.nii");
  ASSERT_TRUE(labels);
  EXPECT_TRUE(labels->structures.empty());
  EXPECT_THAT(labels->notes, testing::ElementsAre(HasSubstr("background only")));
}

LabelName name(std::int64_t label, const std::string& text, std::size_t line) {
  return {{.name = text, .label = label, .code = {}, .color = {}, .terms = {}}, line};
}

TEST(NameLabels, NamesMustFitTheVoxels) {
  const auto labels = read_label_map(row<std::uint8_t>(VoxelType::kUInt8, {1, 2, 3}), "a.nii");
  ASSERT_TRUE(labels);
  ImportedLabels named = *labels;
  ASSERT_TRUE(
      name_labels(named, {name(2, "two", 1), name(1, "one", 2), name(3, "three", 3)}, "n.txt", false));
  EXPECT_THAT(names_of(named), testing::ElementsAre("one", "two", "three"));

  named = *labels;
  const auto missing = name_labels(named, {name(1, "one", 1), name(2, "two", 2)}, "n.txt", true);
  EXPECT_THAT(missing.error().message, AllOf(HasSubstr("n.txt"), HasSubstr("a.nii"), HasSubstr(": 3")));

  named = *labels;
  const std::vector<LabelName> too_many{name(1, "one", 1), name(2, "two", 2), name(9, "nine", 3),
                                        name(3, "three", 4)};
  const auto absent = name_labels(named, too_many, "n.txt", false);
  EXPECT_THAT(absent.error().message, AllOf(HasSubstr("n.txt: line 3"), HasSubstr("label 9"),
                                            HasSubstr("'nine'"), HasSubstr("--allow-empty")));
  named = *labels;
  ASSERT_TRUE(name_labels(named, too_many, "n.txt", true));
  EXPECT_THAT(names_of(named), testing::ElementsAre("one", "two", "three", "nine"));
  EXPECT_EQ(named.structures[3].label, 9);
}

TEST(ImportMasks, RefusesFoldersThatAreNoMasks) {
  const TemporaryFolder folder;
  EXPECT_THAT(import_mask_folder(folder.path()).error().message, HasSubstr("holds no mask"));
  ASSERT_TRUE(write_image(row<std::uint8_t>(VoxelType::kUInt8, {0, 1}), folder.file("liver.nii.gz")));
  ASSERT_TRUE(write_image(row<std::uint8_t>(VoxelType::kUInt8, {0, 1}), folder.file("liver.nrrd")));
  EXPECT_THAT(import_mask_folder(folder.path()).error().message, HasSubstr("same structure"));
  std::filesystem::rename(folder.file("liver.nrrd"), folder.file("LIVER.nrrd"));
  EXPECT_THAT(import_mask_folder(folder.path()).error().message, HasSubstr("same structure"));
  std::filesystem::rename(folder.file("LIVER.nrrd"), folder.file("li\tver.nrrd"));
  EXPECT_THAT(import_mask_folder(folder.path()).error().message, HasSubstr("a tab"));
  std::filesystem::remove(folder.file("li\tver.nrrd"));
  ASSERT_TRUE(write_image(row<std::uint8_t>(VoxelType::kUInt8, {0, 1, 1}), folder.file("spleen.nrrd")));
  EXPECT_THAT(import_mask_folder(folder.path()).error().message,
              AllOf(HasSubstr("2x1x1"), HasSubstr("3x1x1")));
}

TEST(ImportMasks, WhatIsNotZeroIsInside) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_image(row<float>(VoxelType::kFloat32, {0, -1, 0.5f, 255}), folder.file("liver.nrrd")));
  const auto masks = import_mask_folder(folder.path());
  ASSERT_TRUE(masks) << masks.error().message;
  EXPECT_EQ(holder(*masks, 0), -1);
  for (std::size_t v = 1; v < 4; ++v) EXPECT_EQ(holder(*masks, v), 0);
  EXPECT_THAT(masks->notes, testing::ElementsAre(AllOf(HasSubstr("liver.nrrd"), HasSubstr("more values"))));
  ASSERT_TRUE(
      write_image(row<float>(VoxelType::kFloat32, {0, 255, std::nanf(""), 255}), folder.file("liver.nrrd")));
  EXPECT_THAT(import_mask_folder(folder.path())->notes, testing::IsEmpty());
  EXPECT_EQ(mask_of(row<float>(VoxelType::kFloat32, {std::nanf(""), 1}).voxels),
            (std::vector<std::uint8_t>{0, 1}));
}

}  // namespace
}  // namespace splatlas

// DICOM segmentations: masks, fractions and label maps.
#include "preprocess/import/images/dicom/read_segmentation.h"

#include "tests/preprocess/import/images/dicom/import_dicom_fixture.h"

namespace splatlas {
namespace {

using Mask = std::vector<std::uint16_t>;
constexpr std::size_t kPixels = TestSegmentation::kPixels;

/// Pixels first to last - 1 have a value.
Mask pixels(std::size_t first, std::size_t last, std::uint16_t value = 1) {
  Mask mask(kPixels, 0);
  for (std::size_t v = first; v < last; ++v) mask[v] = value;
  return mask;
}

template <typename T>
std::vector<int> voxels_of(const SourceImage& image, std::size_t layer) {
  const std::size_t count = static_cast<std::size_t>(image.grid.voxels());
  const T* const first = image.voxels.as<T>() + layer * count;
  return {first, first + count};
}

/// Slices of kPixels numbers, one after the other.
std::vector<int> joined_slices(const std::vector<Mask>& slices) {
  std::vector<int> all;
  for (const Mask& slice : slices) all.insert(all.end(), slice.begin(), slice.end());
  return all;
}

TestSegmentation three_masks() {
  TestSegmentation segmentation;
  segmentation.segments = {{1, "Liver", {34902, 53485, 50171}, "SCT", "10200004", ""},
                           {2, "Kidney", {}, "SCT", "64033007", "7771000"},
                           {3, "Tumour", {}, "", "", ""}};
  // Segment 3 overlaps 1 in a slice, segment 2 overlaps none. Frames are not in order.
  segmentation.frames = {
      {3, 4, pixels(8, 12)}, {1, 2, pixels(0, 10)}, {2, 2, pixels(10, 35)}, {1, 4, pixels(0, 9)}};
  return segmentation;
}

TEST_F(ImportDicom, MasksThatOverlapAreInFurtherLayers) {
  write_segmentation(three_masks(), file("a"));
  const SourceImage image = imported();
  EXPECT_TRUE(image.is_segmentation);
  EXPECT_EQ(image.grid.size, (Index3{7, 5, 2}));
  EXPECT_EQ(image.grid.spacing_mm, (Vec3{1, 1, 2}));
  EXPECT_EQ(image.grid.origin_lps_mm, (Vec3{0, 0, 2}));
  ASSERT_EQ(image.voxels.type, VoxelType::kUInt8);
  ASSERT_EQ(image.layers, 2u);
  Mask first = pixels(0, 10);
  for (std::size_t v = 10; v < kPixels; ++v) first[v] = 2;
  EXPECT_EQ(voxels_of<std::uint8_t>(image, 0), joined_slices({first, pixels(0, 9)}));
  EXPECT_EQ(voxels_of<std::uint8_t>(image, 1), joined_slices({pixels(0, 0), pixels(8, 12, 3)}));
  ASSERT_EQ(image.segments.size(), 3u);
  EXPECT_EQ(image.segments[0].layer, 0u);
  EXPECT_EQ(image.segments[1].layer, 0u);
  EXPECT_EQ(image.segments[2].layer, 1u);
}

TEST_F(ImportDicom, SegmentsHaveNamesColoursAndCodes) {
  write_segmentation(three_masks(), file("a"));
  const SourceImage image = imported();
  const SourceStructure &liver = image.segments[0].structure, &kidney = image.segments[1].structure;
  EXPECT_EQ(image.segments[0].value, 1);
  EXPECT_EQ(liver.name, "Liver");
  // L 53.26, a 80.11, b 67.22: sRGB red, whose CIELab value is 53.24 80.09 67.20.
  EXPECT_EQ(liver.color, (Rgb{255, 0, 0}));
  EXPECT_THAT(liver.terms, ElementsAre(Term{"SNOMED", "10200004"}));
  EXPECT_EQ(kidney.color, std::nullopt);
  EXPECT_THAT(kidney.terms, ElementsAre(Term{"SNOMED", "64033007"}, Term{"modifier SNOMED", "7771000"}));
  EXPECT_THAT(image.segments[2].structure.terms, IsEmpty());
}

TEST(DicomColors, CielabIsConvertedForDaylight) {
  const auto encode = [](double l, double a, double b) {
    return std::array<double, 3>{l / 100 * 65535, (a + 128) / 255 * 65535, (b + 128) / 255 * 65535};
  };
  // CIELab values of sRGB colours for D65, to two digits: tables of colour science.
  EXPECT_EQ(color_of_lab(encode(100, 0, 0)), (Rgb{255, 255, 255}));
  EXPECT_EQ(color_of_lab(encode(0, 0, 0)), (Rgb{0, 0, 0}));
  EXPECT_EQ(color_of_lab(encode(53.24, 80.09, 67.20)), (Rgb{255, 0, 0}));
  EXPECT_EQ(color_of_lab(encode(87.73, -86.18, 83.18)), (Rgb{0, 255, 0}));
  EXPECT_EQ(color_of_lab(encode(32.30, 79.19, -107.86)), (Rgb{0, 0, 255}));
  EXPECT_EQ(color_of_lab(encode(53.585, 0, 0)), (Rgb{128, 128, 128}));
  EXPECT_EQ(color_of_lab(encode(100, 127, 127)).r, 255);  // outside of sRGB
}

TEST_F(ImportDicom, SlicesWithoutFramesAreEmpty) {
  TestSegmentation segmentation = three_masks();
  segmentation.frames = {{1, 0, pixels(0, 1)}, {1, 5, pixels(1, 2)}, {1, 10, pixels(2, 3)}};
  segmentation.slice_spacing = 2.5;
  write_segmentation(segmentation, file("a"));
  SourceImage image = imported();
  EXPECT_EQ(image.grid.size[2], 5);
  EXPECT_EQ(image.grid.spacing_mm[2], 2.5);
  const Mask none = pixels(0, 0);
  EXPECT_EQ(voxels_of<std::uint8_t>(image, 0),
            joined_slices({pixels(0, 1), none, pixels(1, 2), none, pixels(2, 3)}));
  // A spacing that the positions contradict is none; then the least step counts.
  segmentation.slice_spacing = 2;
  segmentation.frames[2].z = 15;
  write_segmentation(segmentation, file("a"));
  image = imported();
  EXPECT_EQ(image.grid.spacing_mm[2], 5);
  EXPECT_EQ(voxels_of<std::uint8_t>(image, 0),
            joined_slices({pixels(0, 1), pixels(1, 2), none, pixels(2, 3)}));
  segmentation.frames[2].z = 12;
  write_segmentation(segmentation, file("a"));
  image = imported();  // steps of 5 and 7 mm: the nearest frame
  EXPECT_EQ(voxels_of<std::uint8_t>(image, 0),
            joined_slices({pixels(0, 1), pixels(1, 2), pixels(2, 3), pixels(2, 3)}));
  EXPECT_THAT(notes_of(image), ElementsAre(HasSubstr("steps of 5 to 7 mm become 5 mm")));
}

TEST_F(ImportDicom, FractionsAboveOneHalfBelong) {
  TestSegmentation segmentation = three_masks();
  segmentation.type = "FRACTIONAL";
  segmentation.bits = 8;
  Mask fractions = pixels(0, 10, 100);  // of 200
  fractions[3] = 101;
  fractions[4] = 200;
  segmentation.frames = {{1, 0, fractions}, {2, 1, pixels(0, 2, 199)}, {3, 1, pixels(0, 9, 80)}};
  write_segmentation(segmentation, file("a"));
  EXPECT_THAT(
      notes_of(imported()),
      ElementsAre("1 segment has no fraction above one half, which a voxel needs: Tumour (largest 0.4)"));
  Mask first = pixels(3, 5);
  EXPECT_EQ(voxels_of<std::uint8_t>(imported(), 0), joined_slices({first, pixels(0, 2, 2)}));
}

TEST_F(ImportDicom, LabelMapsHoldSegmentNumbers) {
  for (const int bits : {8, 16}) {
    TestSegmentation segmentation;
    segmentation.type = "LABELMAP";
    segmentation.bits = bits;
    const int large = bits == 8 ? 200 : 1200;
    segmentation.segments = {
        {0, "Background", {}, "", "", ""}, {large, "Large", {}, "", "", ""}, {5, "Five", {}, "", "", ""}};
    Mask slice = pixels(0, 4, static_cast<std::uint16_t>(large));
    slice[7] = 5;
    segmentation.frames = {{0, 1, pixels(3, 9, 5)}, {0, 0, slice}};
    write_segmentation(segmentation, file("a"));
    const SourceImage image = imported();
    ASSERT_EQ(image.voxels.type, bits == 8 ? VoxelType::kUInt8 : VoxelType::kUInt16);
    const std::vector<int> expected = joined_slices({slice, pixels(3, 9, 5)});
    EXPECT_EQ(bits == 8 ? voxels_of<std::uint8_t>(image, 0) : voxels_of<std::uint16_t>(image, 0), expected);
    ASSERT_EQ(image.segments.size(), 2u);
    EXPECT_EQ(image.segments[0].value, 5);
    EXPECT_EQ(image.segments[1].value, large);
    EXPECT_EQ(image.segments[1].structure.name, "Large");
  }
}

TEST_F(ImportDicom, ThePaddingOfALabelMapIsItsBackground) {
  TestSegmentation segmentation;
  segmentation.type = "LABELMAP";
  segmentation.bits = 8;
  segmentation.segments = {{255, "Background", {}, "", "", ""}, {5, "Five", {}, "", "", ""}};
  Mask slice = pixels(0, kPixels, 255);
  slice[7] = 5;
  segmentation.frames = {{0, 0, slice}};
  segmentation.texts = {{{0x0028, 0x0120}, "255"}, {{0x0018, 0x0050}, "3"}};
  write_segmentation(segmentation, file("a"));
  const SourceImage image = imported();
  EXPECT_EQ(voxels_of<std::uint8_t>(image, 0), joined_slices({pixels(7, 8, 5)}));
  EXPECT_EQ(image.segments.size(), 1u);
}

TEST_F(ImportDicom, LargeSegmentNumbersNeedTwoBytes) {
  TestSegmentation segmentation = three_masks();
  segmentation.segments[2].number = 300;
  segmentation.frames[0].segment = 300;
  write_segmentation(segmentation, file("a"));
  const SourceImage image = imported();
  ASSERT_EQ(image.voxels.type, VoxelType::kUInt16);
  EXPECT_EQ(voxels_of<std::uint16_t>(image, 1), joined_slices({pixels(0, 0), pixels(8, 12, 300)}));
}

TEST_F(ImportDicom, RefusesSegmentationsThatContradictThemselves) {
  const auto refused = [&](const TestSegmentation& segmentation, const std::string& message) {
    write_segmentation(segmentation, file("a"));
    EXPECT_THAT(import(), FailsWith(ErrorCode::kFailed, HasSubstr("a: " + message)));
  };
  TestSegmentation segmentation = three_masks();
  segmentation.frames[1].segment = 4;
  refused(segmentation, "has a frame of segment 4, which is not in its list");
  segmentation = three_masks();
  segmentation.segments[2].number = 2;
  refused(segmentation, "has two segments with number 2");
  segmentation.segments[2].number = 0;
  refused(segmentation, "has a segment with number 0");
  segmentation.segments.clear();
  refused(segmentation, "is a segmentation without segments");
  segmentation = three_masks();
  segmentation.type = "SURFACE";
  refused(segmentation, "is a segmentation of an unknown type");
  segmentation = three_masks();
  segmentation.frames[3].values.clear();
  refused(segmentation, "has 14 bytes of pixels instead of 18");
}

TEST_F(ImportDicom, LabelsThatCannotBeNamesAreReplaced) {
  TestSegmentation segmentation = three_masks();
  segmentation.segments[1].label = "";
  segmentation.segments[2].label = "a\x1b[31m";
  write_segmentation(segmentation, file("a"));
  const SourceImage image = imported();
  EXPECT_EQ(image.segments[1].structure.name, "segment 2");
  EXPECT_EQ(image.segments[2].structure.name, "segment 3");
  EXPECT_THAT(notes_of(image),
              ElementsAre("2 segments have labels that cannot be names: segment 2, segment 3"));
}

}  // namespace
}  // namespace splatlas

// DICOM files of scanners and of other software, where SPLATLAS_TEST_DATA names their folder.
#include <cstdlib>

#include "tests/preprocess/import/images/dicom/import_dicom_fixture.h"

namespace splatlas {
namespace {

class RealDicom : public testing::Test {
 protected:
  void SetUp() override {
    const char* const folder = std::getenv("SPLATLAS_TEST_DATA");
    if (folder == nullptr) GTEST_SKIP() << "SPLATLAS_TEST_DATA is not set";
    root_ = folder;
  }

  [[nodiscard]] Result<SourceImage> import(const std::string& name, const std::string& series = "") const {
    return import_dicom(root_ / "formats/dicom" / name, {series, {}});
  }
  [[nodiscard]] SourceImage imported(const std::string& name, const std::string& series = "") const {
    return value_or_throw(import(name, series));
  }

  struct Values {
    double min = 0, max = 0, mean = 0;
  };
  static Values values_of(const SourceImage& image) {
    Values values;
    visit_voxel_type(image.voxels.type, [&]<typename T>(T) {
      const T* const first = image.voxels.as<T>();
      const auto count = image.grid.voxels();
      const auto [min, max] = std::minmax_element(first, first + count);
      double sum = 0;
      for (std::int64_t v = 0; v < count; ++v) sum += static_cast<double>(first[v]);
      values = {static_cast<double>(*min), static_cast<double>(*max), sum / static_cast<double>(count)};
    });
    return values;
  }
  static void expect_values(const SourceImage& image, double min, double max, double mean) {
    const Values values = values_of(image);
    EXPECT_EQ(values.min, min);
    EXPECT_EQ(values.max, max);
    EXPECT_NEAR(values.mean, mean, 5e-5);  // four digits are known
  }
  static std::int64_t voxels_of(const SourceImage& image, const SourceSegment& segment) {
    std::int64_t count = 0;
    visit_voxel_type(image.voxels.type, [&]<typename T>(T) {
      const T* const first =
          image.voxels.as<T>() + static_cast<std::int64_t>(segment.layer) * image.grid.voxels();
      count = std::count(first, first + image.grid.voxels(), static_cast<T>(segment.value));
    });
    return count;
  }
  static std::vector<std::pair<std::string, std::int64_t>> counts_of(const SourceImage& image) {
    std::vector<std::pair<std::string, std::int64_t>> counts;
    for (const SourceSegment& segment : image.segments)
      counts.emplace_back(segment.structure.name, voxels_of(image, segment));
    return counts;
  }

  std::filesystem::path root_;
};

TEST_F(RealDicom, OneSeriesInFiveCodings) {
  const SourceImage raw = imported("torchio_series");
  EXPECT_EQ(raw.grid.size, (Index3{88, 128, 17}));
  EXPECT_EQ(raw.grid.spacing_mm, (Vec3{2, 2, 2}));
  EXPECT_EQ(raw.grid.direction_lps, (Matrix3{-1, 0, 0, 0, -1, 0, 0, 0, 1}));
  EXPECT_EQ(raw.grid.origin_lps_mm, (Vec3{82.1807, 122.163, -24.707}));
  EXPECT_EQ(raw.voxels.type, VoxelType::kInt16);
  expect_values(raw, 0, 696, 148.2183);
  for (const std::string coding : {"dcmtk_jpegll_70", "dcmtk_jpegls_80", "dcmtk_rle", "gdcm_j2k_90"})
    EXPECT_EQ(imported("series_" + coding).voxels, raw.voxels) << coding;
}

TEST_F(RealDicom, OneSliceInTenCodings) {
  const std::string start = "transfer_syntaxes/CTImage.dcm_", uid = "TransferSyntax_1.2.840.10008.1.2";
  for (const std::string& lossless :
       {"BigEndianExplicit" + uid + ".2", "DeflatedExplicitVRLittleEndian" + uid + ".1.99",
        "JPEG2000LosslessOnly" + uid + ".4.90", "JPEGLSLossless" + uid + ".4.80",
        "JPEGProcess14SV1" + uid + ".4.70", "LittleEndianImplicit" + uid, "RLELossless" + uid + ".5"})
    expect_values(imported(start + lossless + ".dcm"), -2000 - 1024, 2402 - 1024, 74.9236 - 1024);
  const Values jpeg_2000 = values_of(imported(start + "JPEG2000" + uid + ".4.91.dcm"));
  EXPECT_EQ(jpeg_2000.min, -2003 - 1024);
  EXPECT_EQ(jpeg_2000.max, 2401 - 1024);
  const Values jpeg_ls = values_of(imported(start + "JPEGLSLossy" + uid + ".4.81.dcm"));
  EXPECT_EQ(jpeg_ls.min, -2001 - 1024);
  EXPECT_EQ(jpeg_ls.max, 2401 - 1024);
  // Frames of several fragments without a table.
  const SourceImage fragments = imported("transfer_syntaxes/CT0012.fragmented_no_bot_jpeg_baseline.51.dcm");
  EXPECT_EQ(fragments.grid.size, (Index3{512, 512, 2}));
  EXPECT_EQ(values_of(fragments).min, 1010 - 1024);
  EXPECT_EQ(values_of(fragments).max, 2223 - 1024);
}

TEST_F(RealDicom, ATiltThatNoAttributeNames) {
  const SourceImage image = imported("gantry_tilt");
  EXPECT_EQ(image.grid.size, (Index3{512, 512, 4}));
  EXPECT_EQ(image.grid.spacing_mm[0], 0.41796875);
  EXPECT_NEAR(image.grid.spacing_mm[2], 5, 1e-5);  // positions of six digits
  const double area = 0.41796875 * 0.41796875;
  EXPECT_NEAR(voxel_volume_mm3(image.grid) / area, 4.8515, 5e-5);  // along the normal
  ASSERT_EQ(image.notes.all().size(), 1u);
  EXPECT_THAT(image.notes.all()[0].message(), HasSubstr("14.0 degrees"));
}

TEST_F(RealDicom, SeriesOfScanners) {
  const SourceImage mr = imported("mr_series");
  EXPECT_EQ(mr.grid.size, (Index3{256, 256, 4}));
  EXPECT_NEAR(std::abs(mr.grid.direction_lps[0]), std::sin(3 * 3.14159265 / 180), 1e-3);  // about 3 degrees
  expect_values(mr, 0, 254, 126.9966);
  const SourceImage head = imported("slicer_cthead");
  EXPECT_EQ(head.grid.size, (Index3{64, 64, 93}));
  EXPECT_EQ(head.grid.spacing_mm, (Vec3{3.2, 3.2, 1.5}));
  expect_values(head, 0, 3926, 507.6873);
  const SourceImage uneven = imported("monai_ct_tiny");
  EXPECT_EQ(uneven.grid.size, (Index3{16, 16, 165}));
  EXPECT_THAT(uneven.notes.all()[0].message(), HasSubstr("become 1.25 mm"));
  const SourceImage ct = value_or_throw(import_dicom(root_ / "totalseg/example_ct_dicom", {}));
  EXPECT_EQ(ct.grid.size, (Index3{512, 512, 20}));
  EXPECT_EQ(ct.grid.spacing_mm[2], 2);
}

TEST_F(RealDicom, StoredBitsAndScales) {
  expect_values(imported("stored_bits/12bitUnsigned_0x0F0F.dcm"), 0, 4095, 274.4983);
  expect_values(imported("stored_bits/12bitSigned_0x0F0F.dcm"), -2048, 2047, 258.5539);
  const SourceImage philips = imported("rescale_philips");
  EXPECT_EQ(philips.voxels.type, VoxelType::kFloat32);
  EXPECT_EQ(values_of(philips).max, static_cast<float>(256 * 2.11184371184371));
}

TEST_F(RealDicom, EnhancedImages) {
  const SourceImage siemens = imported("enhanced_multiframe/6_1.dcm");
  EXPECT_EQ(siemens.grid.size, (Index3{64, 64, 6}));
  EXPECT_EQ(siemens.grid.spacing_mm[0], 3.375);
  EXPECT_NEAR(siemens.grid.spacing_mm[2], 2.4, 1e-4);  // -5.4 to 6.6 in five steps, rounded
  const std::string philips = "enhanced_multiframe/IM_0027_fMAP.dcm";
  EXPECT_THAT(import(philips), FailsWith(ErrorCode::kUsage, HasSubstr("holds 2 series")));
  for (const std::string number : {"1", "2"})
    EXPECT_EQ(imported(philips, number).grid.size, (Index3{64, 64, 32}));
  EXPECT_GE(values_of(imported(philips, "1")).min, -500);
  EXPECT_EQ(values_of(imported(philips, "2")).min, 0);
}

TEST_F(RealDicom, Segmentations) {
  const SourceImage nodule = imported("seg/nodule_01_annotation_0.dcm");
  EXPECT_EQ(nodule.grid.size, (Index3{512, 512, 9}));
  EXPECT_EQ(nodule.grid.origin_lps_mm[2], -125);
  EXPECT_THAT(counts_of(nodule), ElementsAre(std::pair("Nodule 1 - Annotation 0", 5498)));
  const SourceImage tumour = imported("seg/tumor_User1_Manual_Trial1.dcm");
  EXPECT_THAT(counts_of(tumour),
              ElementsAre(std::pair("Neoplasm, Primary", 54), std::pair("Neoplasm, Secondary", 212)));
  EXPECT_EQ(tumour.segments[0].structure.color, (Rgb{128, 174, 128}));  // that of "tissue" in 3D Slicer
  EXPECT_EQ(tumour.grid.spacing_mm[2], 3.375);
  const SourceImage fractions = imported("seg/made_fractional_probability.dcm");
  const SourceImage overlapping = imported("seg/made_binary_overlapping.dcm");
  const SourceImage labels = imported("seg/made_labelmap.dcm");
  for (const SourceImage* image : {&fractions, &labels})
    EXPECT_THAT(counts_of(*image), ElementsAre(std::pair("Bone", 57714), std::pair("Soft tissue", 113736)));
  EXPECT_THAT(counts_of(overlapping),
              ElementsAre(std::pair("Bone", 57714), std::pair("Soft tissue", 191488)));
  EXPECT_EQ(overlapping.layers, 2u);
  EXPECT_EQ(labels.voxels, fractions.voxels);
  EXPECT_EQ(labels.grid, imported("torchio_series").grid);
}

}  // namespace
}  // namespace splatlas

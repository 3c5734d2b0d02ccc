// Choice among several DICOM series, and series that hold several volumes.
#include "tests/preprocess/import/images/dicom/import_dicom_fixture.h"
#include "tests/support/file_bytes.h"

namespace splatlas {
namespace {

using testing::EndsWith;

TEST_F(ImportDicom, SeveralSeriesMustBeChosenFrom) {
  write_series();
  for (int k = 0; k < 3; ++k) {
    TestSlice slice = axial(k + 20);
    slice.spacing = {0.75, 0.75};
    slice.texts = {{kSeriesUidTag, "1.9"}, {kSeriesNumberTag, "3"}};
    write_slice(slice, file(fmt::format("other{}", k)));
  }
  const std::string list =
      "holds 2 series; choose one with --series N: 1: CT 8x6x3, 0.75x0.75x2 mm; 2: CT 8x6x5, 0.25x0.5x2 mm";
  EXPECT_THAT(import(), FailsWith(ErrorCode::kUsage, folder_.path().string() + ": " + list));
  expect_ramps(imported("1"), 3, 20);
  expect_ramps(imported("2"), 5);
  expect_ramps(imported("1.9"), 3, 20);
  expect_ramps(imported("1.2.3"), 5);
  for (const std::string unknown : {"0", "3", "1.2", "x", "99999999999999999999", "-1"})
    EXPECT_THAT(import(unknown),
                FailsWith(ErrorCode::kUsage, EndsWith("has no series " + unknown + "; it " + list)));
}

TEST_F(ImportDicom, SeriesThatLookAlikeAreToldApart) {
  for (int k = 0; k < 3; ++k) {
    for (int frame = 0; frame < 3; ++frame) {
      TestSlice slice = axial(k);
      slice.stored = ramp(k + 10 * frame);
      slice.texts = {{{0x0020, 0x0052}, fmt::format("1.7.{}", frame)}};
      write_slice(slice, file(fmt::format("{}{}", frame, k)));
    }
  }
  EXPECT_THAT(import(), FailsWith(ErrorCode::kUsage,
                                  HasSubstr("; 2: CT 8x6x3, 0.25x0.5x2 mm, number 7, normal (0, 0, 1), "
                                            "frame of reference 2 of 3, 10 at (-1, 2, 10); 3: CT")));
  expect_ramps(imported("3"), 3, 20);
}

TEST_F(ImportDicom, AFolderOfImagesAndSegmentsHasBoth) {
  write_series();
  TestSegmentation segmentation;
  segmentation.segments = {{1, "Liver", {}, "", "", ""}};
  segmentation.frames = {{1, 4, std::vector<std::uint16_t>(TestSegmentation::kPixels, 1)}};
  write_segmentation(segmentation, file("seg.dcm"));
  expect_ramps(imported(), 5);
  ImageOptions options;
  options.labels = true;
  EXPECT_EQ(value_or_throw(import_dicom(folder_.path(), options)).segments.size(), 1u);
  write_segmentation(segmentation, file("seg2.dcm"));
  EXPECT_THAT(import_dicom(folder_.path(), options),
              FailsWith(ErrorCode::kUsage, AllOf(HasSubstr("holds 2 segmentations; give the file of one: "),
                                                 HasSubstr("seg2.dcm"))));
}

TEST_F(ImportDicom, TwoTimePointsAreTwoVolumes) {
  for (int k = 0; k < 4; ++k) {
    for (int time = 0; time < 2; ++time) {
      TestSlice slice = axial(k);
      slice.stored = ramp(k + 10 * time);
      slice.texts = {{kTimeTag, std::to_string(10 - time)}};  // 9 before 10
      write_slice(slice, file(fmt::format("slice{}", 2 * k + time)));
    }
  }
  EXPECT_THAT(import(),
              FailsWith(ErrorCode::kUsage,
                        EndsWith("1: CT 8x6x4, 0.25x0.5x2 mm, time 1 of 2; 2: CT 8x6x4, 0.25x0.5x2 mm, "
                                 "time 2 of 2")));
  expect_ramps(imported("1"), 4, 10);
  expect_ramps(imported("2"), 4, 0);
  EXPECT_THAT(import("1.2.3"), FailsWith(ErrorCode::kUsage, HasSubstr("series 1.2.3 has 2 volumes")));
}

TEST_F(ImportDicom, ATimePointWithAGapIsNotMixedWithAnother) {
  for (int k = 0; k < 4; ++k) {
    for (int time = 0; time < 2; ++time) {
      if (k == 2 && time == 1) continue;
      TestSlice slice = axial(k);
      slice.stored = ramp(k + 10 * time);
      slice.texts = {{kTimeTag, std::to_string(time)}};
      write_slice(slice, file(fmt::format("slice{}", 2 * k + time)));
    }
  }
  expect_ramps(imported("1"), 4);
  expect_ramps(imported("2"), 4, 10);
}

TEST_F(ImportDicom, SlabsOfOtherThicknessAreOneVolume) {
  int names = 0;
  const auto slab = [&](double start, double step, const std::string& thickness, int slices) {
    for (int k = 0; k < slices; ++k) {
      TestSlice slice = axial(k);
      slice.position = {0, 0, start + step * k};
      slice.texts = {{{0x0018, 0x0050}, thickness}, {{0x0020, 0x0012}, thickness}};
      write_slice(slice, file(fmt::format("slice{}", names++)));
    }
  };
  slab(0, 4, "4", 5);
  slab(21.5, 7, "7", 3);
  const SourceImage image = imported();
  EXPECT_EQ(image.grid.size[2], 10);                                       // 35.5 mm at steps of 4
  EXPECT_EQ(image.voxels.as<std::int16_t>()[6 * TestSlice::kPixels], 36);  // 2.5 of 7 mm from ramp(0) to (1)
}

TEST_F(ImportDicom, AcquisitionsOfOneSliceEachAreOneVolume) {
  for (int k = 0; k < 5; ++k) {
    TestSlice slice = axial(k);
    slice.texts = {{{0x0020, 0x0012}, std::to_string(k)}};
    write_slice(slice, file(fmt::format("slice{}", k)));
  }
  expect_ramps(imported(), 5);
}

TEST_F(ImportDicom, OneSliceOfAnotherAcquisitionIsADuplicate) {
  write_series();
  TestSlice copy = axial(3);
  copy.stored = ramp(77);
  copy.texts = {{{0x0020, 0x0012}, "2"}};
  write_slice(copy, file("slice99"));
  const SourceImage image = imported();
  expect_ramps(image, 5);
  EXPECT_THAT(notes_of(image), ElementsAre("1 slice repeats another's position and is ignored: (-1, 2, 16)"));
}

TEST_F(ImportDicom, KindsOfFramesAreVolumes) {
  std::vector<TestFrame> frames;
  for (const int k : {2, 0, 1}) {
    frames.push_back({{0, 0, 1. * k}, 2, 1, "ORIGINAL\\PRIMARY\\M", ramp(k)});
    frames.push_back({{0, 0, 1. * k}, 1, -500, "ORIGINAL\\PRIMARY\\PHASE MAP", ramp(k)});
  }
  write_enhanced(frames, file("a"));
  EXPECT_THAT(import(), FailsWith(ErrorCode::kUsage, AllOf(HasSubstr("image type 1 of 2"),
                                                           HasSubstr("MR 8x6x3, 0.5x0.5x1 mm"))));
  const SourceImage magnitude = imported("1"), phase = imported("2");
  ASSERT_EQ(magnitude.voxels.type, VoxelType::kFloat32);
  EXPECT_EQ(magnitude.voxels.as<float>()[TestSlice::kPixels + 3], 2 * 103 + 1);
  ASSERT_EQ(phase.voxels.type, VoxelType::kInt16);  // -500..65035 by its bits, -500..-253 by its pixels
  EXPECT_EQ(phase.voxels.as<std::int16_t>()[TestSlice::kPixels + 3], 103 - 500);
}

TEST_F(ImportDicom, ALocalizerIsASeriesOfItsOwn) {
  write_series();
  TestSlice localizer = axial(0);
  localizer.axes = {0, 1, 0, 0, 0, -1};
  write_slice(localizer, file("a"));
  EXPECT_THAT(import(), FailsWith(ErrorCode::kUsage, HasSubstr("1: CT 8x6x1, 0.25x0.5 mm; 2: CT 8x6x5")));
  expect_ramps(imported("2"), 5);
}

TEST_F(ImportDicom, ASliceOfOtherSpacingIsNotMixedIn) {
  write_series();
  TestSlice slice = axial(2);
  slice.spacing = {0.5, 0.2502};
  write_slice(slice, file("slice7"));
  EXPECT_THAT(import(), FailsWith(ErrorCode::kUsage, HasSubstr("holds 2 series")));
  expect_ramps(imported("1"), 5);
  expect_ramps(imported("2"), 1, 2);
}

TEST_F(ImportDicom, OtherFilesOfAFolderAreIgnored) {
  std::filesystem::create_directories(file("deep/er"));
  for (int k = 0; k < 5; ++k) write_slice(axial(k), file(fmt::format("deep/er/IM{}.dcm", k)));
  write_bytes(file("README"), "text");
  write_bytes(file("empty"), "");
  TestSlice report = axial(0);
  report.class_uid = kReportClass;
  report.erased = {{0x0028, 0x0010}, {0x7fe0, 0x0010}};
  write_slice(report, file("report"));
  TestSlice index = report;
  index.class_uid = "1.2.840.10008.1.3.10";
  write_slice(index, file("DICOMDIR"));
  expect_ramps(imported(), 5);
  EXPECT_THAT(import_dicom(file("report"), {}), FailsWith(ErrorCode::kFailed, HasSubstr("holds no image")));
  EXPECT_THAT(import_dicom(file("README"), {}), FailsWith(ErrorCode::kFailed, HasSubstr("is no DICOM file")));
  EXPECT_TRUE(is_dicom(folder_.path()));
  EXPECT_TRUE(is_dicom(file("report")));
  EXPECT_FALSE(is_dicom(file("README")));
  EXPECT_FALSE(is_dicom(file("missing")));
  std::filesystem::remove_all(file("deep"));
  EXPECT_THAT(import(), FailsWith(ErrorCode::kFailed, HasSubstr("holds no DICOM image")));
  std::filesystem::remove(file("report"));
  std::filesystem::remove(file("DICOMDIR"));
  EXPECT_FALSE(is_dicom(folder_.path()));
}

TEST_F(ImportDicom, FilesMayBeginWithTheirDataSet) {
  for (const TestCoding coding : {TestCoding::kImplicit, TestCoding::kExplicit}) {
    for (int k = 0; k < 5; ++k) {
      write_slice(axial(k), file(fmt::format("{}", k)), coding);
      const std::string bytes = read_bytes(file(fmt::format("{}", k)));
      const auto meta = static_cast<std::size_t>(static_cast<unsigned char>(bytes[140]));
      write_bytes(file(fmt::format("{}", k)), bytes.substr(144 + meta));  // without preamble and meta header
    }
    EXPECT_TRUE(is_dicom(folder_.path()));
    expect_ramps(imported(), 5);
  }
}

TEST_F(ImportDicom, UnusableImagesOfOtherSeriesAreNoted) {
  write_series();
  TestSlice projection = axial(0);
  projection.erased = {{0x0020, 0x0032}};
  write_slice(projection, file("a"));
  EXPECT_THAT(import(), FailsWith(ErrorCode::kFailed, HasSubstr("has no ImagePositionPatient")));
  projection.texts = {{kSeriesUidTag, "1.9"}};
  write_slice(projection, file("a"));
  EXPECT_THAT(notes_of(imported()),
              ElementsAre("1 image of other series cannot be a volume and is ignored: image 1"));
}

TEST(DicomLibraries, GdcmIsNotLoaded) {
  // It exports functions of DCMTK's CharLS with other structures.
  const std::string maps = read_bytes("/proc/self/maps");
  EXPECT_THAT(maps, HasSubstr("libdcmjpls"));
  EXPECT_THAT(maps, testing::Not(HasSubstr("gdcm")));
  EXPECT_THAT(maps, testing::Not(HasSubstr("libcharls")));
}

}  // namespace
}  // namespace splatlas

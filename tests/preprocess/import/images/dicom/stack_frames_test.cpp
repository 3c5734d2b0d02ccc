// Order, geometry and completeness of DICOM series.
#include <cmath>
#include <numbers>

#include "tests/preprocess/import/images/dicom/import_dicom_fixture.h"
#include "tests/support/file_bytes.h"

namespace splatlas {
namespace {

TEST_F(ImportDicom, SlicesAreOrderedByPosition) {
  write_series();
  const SourceImage image = imported();
  expect_ramps(image, 5);
  EXPECT_EQ(image.grid.size, (Index3{8, 6, 5}));
  // The file puts the spacing of rows first; along a row it is 0.25 mm.
  EXPECT_EQ(image.grid.spacing_mm, (Vec3{0.25, 0.5, 2}));
  EXPECT_EQ(image.grid.origin_lps_mm, (Vec3{-1, 2, 10}));
  EXPECT_EQ(image.grid.direction_lps, (Matrix3{1, 0, 0, 0, 1, 0, 0, 0, 1}));
  EXPECT_EQ(image.layers, 1u);
  EXPECT_FALSE(image.is_segmentation);
  EXPECT_THAT(notes_of(image), IsEmpty());
}

TEST_F(ImportDicom, ATiltedStackHasAShearedGrid) {
  const double angle = 15 * std::numbers::pi / 180;
  const Vec3 step{0, -2.5 * std::sin(angle), 2.5 * std::cos(angle)};
  for (int k = 0; k < 5; ++k) {
    TestSlice slice = axial(k);
    slice.position = {1, 2 + k * step[1], 3 + k * step[2]};
    write_slice(slice, file(fmt::format("slice{}", k)));
  }
  const SourceImage image = imported();
  expect_ramps(image, 5);
  EXPECT_NEAR(image.grid.spacing_mm[2], 2.5, 1e-9);  // ten digits in the file
  EXPECT_NEAR(image.grid.direction_lps[2], 0, 1e-9);
  EXPECT_NEAR(image.grid.direction_lps[5], -std::sin(angle), 1e-9);
  EXPECT_NEAR(image.grid.direction_lps[8], std::cos(angle), 1e-9);
  const Vec3 last = index_to_lps_mm(image.grid).apply({0, 0, 4});
  EXPECT_NEAR(last[1], 2 + 4 * step[1], 1e-8);
  EXPECT_NEAR(last[2], 3 + 4 * step[2], 1e-8);
  EXPECT_THAT(notes_of(image), ElementsAre("1 stack of slices is tilted; its grid is sheared: 15.0 degrees"));
}

TEST_F(ImportDicom, MissingSlicesAreInterpolated) {
  write_series();
  std::filesystem::remove(file("slice7"));  // z = 14
  SourceImage image = imported();
  expect_ramps(image, 5);
  EXPECT_EQ(image.grid.spacing_mm[2], 2);
  const std::string note =
      "1 stack of slices has uneven steps and is interpolated to even ones: steps of 2 to ";
  EXPECT_THAT(notes_of(image), ElementsAre(note + "4 mm become 2 mm, new slices at (-1, 2, 14)"));
  EXPECT_TRUE(image.notes.all()[0].level() == NoteLevel::kWarning);
  std::filesystem::remove(file("slice6"));
  image = imported();
  expect_ramps(image, 5);
  EXPECT_THAT(notes_of(image),
              ElementsAre(note + "6 mm become 2 mm, new slices at (-1, 2, 14), (-1, 2, 16)"));
}

TEST_F(ImportDicom, OneWarningTellsOfStepsAndTilt) {
  const double tilt = std::tan(20 * std::numbers::pi / 180);
  const std::array<double, 6> heights{0, 4, 8, 12, 19, 26};
  for (int k = 0; k < 6; ++k) {
    TestSlice slice = axial(k);
    const double z = heights[static_cast<std::size_t>(k)];
    slice.position = {1, -tilt * z, z};
    write_slice(slice, file(fmt::format("slice{}", k)));
  }
  const SourceImage image = imported();
  EXPECT_EQ(image.grid.size[2], 8);
  const Vec3 last = index_to_lps_mm(image.grid).apply({0, 0, 7});
  EXPECT_NEAR(last[2], 28, 1e-7);
  EXPECT_NEAR(last[1], -tilt * 28, 1e-7);
  EXPECT_EQ(image.voxels.as<std::int16_t>()[5 * TestSlice::kPixels], 414);
  EXPECT_THAT(notes_of(image),
              ElementsAre(AllOf(HasSubstr("tilt 20.0 degrees, steps of 4 to 7 mm become 4 mm"),
                                HasSubstr(" and 1 more"))));
}

TEST_F(ImportDicom, RoundedPositionsAreEven) {
  for (int k = 0; k < 5; ++k) {
    TestSlice slice = axial(k);
    slice.position[2] = std::round(100 * 0.625 * k) / 100;  // 0.63, 1.25, 1.88, 2.5
    write_slice(slice, file(fmt::format("slice{}", k)));
  }
  EXPECT_NEAR(imported().grid.spacing_mm[2], 0.625, 1e-12);
}

TEST_F(ImportDicom, ASliceBesideTheOthersIsAnError) {
  write_series();
  TestSlice slice = axial(2);
  slice.position[0] = 1;
  write_slice(slice, file("slice7"));
  EXPECT_THAT(import(),
              FailsWith(ErrorCode::kFailed, HasSubstr("a slice at (1, 2, 14) that is 2 mm off the line")));
}

TEST_F(ImportDicom, TheFirstOfDuplicatesIsKept) {
  write_series();
  TestSlice copy = axial(3);
  copy.stored = ramp(77);
  write_slice(copy, file("slice99"));
  copy.position = axial(1).position;
  copy.position[2] += 0.05;  // nearer than any step
  write_slice(copy, file("slice98"));
  const SourceImage image = imported();
  expect_ramps(image, 5);
  EXPECT_THAT(notes_of(image),
              ElementsAre("2 slices repeat others' positions and are ignored: (-1, 2, 12.05), (-1, 2, 16)"));
}

TEST_F(ImportDicom, OneSliceHasItsThickness) {
  TestSlice slice = axial(0);
  slice.texts = {{{0x0018, 0x0050}, "1.5"}};
  write_slice(slice, file("a"));
  EXPECT_EQ(imported().grid.spacing_mm[2], 1.5);
  slice.texts.clear();
  write_slice(slice, file("a"));
  const SourceImage image = imported();
  EXPECT_EQ(image.grid.spacing_mm[2], 1);
  EXPECT_THAT(notes_of(image), ElementsAre("1 slice has no thickness; 1 mm is assumed: (-1, 2, 10)"));
}

}  // namespace
}  // namespace splatlas

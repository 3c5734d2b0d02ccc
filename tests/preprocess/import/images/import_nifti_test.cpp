// Values, byte orders and geometry of NIfTI images.
#include <algorithm>
#include <cmath>
#include <random>

#include "tests/preprocess/import/images/import_image_fixture.h"
#include "tests/support/fails_with.h"

namespace splatlas {
namespace {

TEST_F(ImportImage, AScaledNiftiIsReadInItsValues) {
  const std::string scaled = with_number<float>(with_number<float>(nifti(), 112, 0.5f), 116, 3.f);
  const Image image = imported("a.nii", scaled);
  visit_voxel_type(image.voxels.type, [&]<typename T>(T) {
    for (std::size_t v = 0; v < RawImage::kVoxels; ++v) {
      ASSERT_EQ(static_cast<double>(image.voxels.as<T>()[v]), 0.5 * (static_cast<double>(v) - 100) + 3);
    }
  });
}

TEST_F(ImportImage, ANiftiSlopeOfZeroScalesNothing) {
  expect_raw_image(imported("a.nii", with_number<float>(with_number<float>(nifti(), 112, 0), 116, 3)));
}

/// Every number of nifti() in the other byte order.
std::string in_other_order(std::string bytes) {
  const auto swap = [&](std::size_t offset, std::size_t size, std::size_t count) {
    for (std::size_t n = 0; n < count; ++n) {
      const auto first = bytes.begin() + static_cast<std::ptrdiff_t>(offset + n * size);
      std::reverse(first, first + static_cast<std::ptrdiff_t>(size));
    }
  };
  swap(0, 4, 1);     // sizeof_hdr
  swap(40, 2, 8);    // dim
  swap(70, 2, 2);    // datatype, bitpix
  swap(76, 4, 11);   // pixdim, vox_offset, slope, intercept
  swap(252, 2, 2);   // form codes
  swap(256, 4, 18);  // qform, sform
  swap(352, 2, RawImage::kVoxels);
  return bytes;
}

TEST_F(ImportImage, ReadsNiftiInEitherByteOrder) {
  const Image other = imported("b.nii", in_other_order(nifti()));
  expect_raw_image(other);
  EXPECT_EQ(imported("a.nii", nifti()).grid, other.grid);
}

TEST_F(ImportImage, TakesEverySformThatIsARotationInFloats) {
  std::mt19937 random(20);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<float> spacing(0.1f, 5.f);
  for (int n = 0; n < 1000; ++n) {
    // A random quaternion, mirrored half of the time.
    double a = normal(random), b = normal(random), c = normal(random), d = normal(random);
    const double length = std::sqrt(a * a + b * b + c * c + d * d);
    a /= length, b /= length, c /= length, d /= length;
    const double mirror = n % 2 == 0 ? 1 : -1;
    const Matrix3 ras{a * a + b * b - c * c - d * d,
                      2 * (b * c - a * d),
                      mirror * 2 * (b * d + a * c),
                      2 * (b * c + a * d),
                      a * a + c * c - b * b - d * d,
                      mirror * 2 * (c * d - a * b),
                      2 * (b * d - a * c),
                      2 * (c * d + a * b),
                      mirror * (a * a + d * d - b * b - c * c)};
    std::string bytes = nifti();
    Vec3 spacings;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float mm = spacing(random);
      spacings[axis] = double{mm};
      bytes = with_number<float>(bytes, 80 + 4 * axis, mm);
      for (std::size_t row = 0; row < 3; ++row) {
        bytes = with_number<float>(bytes, 280 + 16 * row + 4 * axis,
                                   static_cast<float>(ras[3 * row + axis] * double{mm}));
      }
    }
    const Grid grid = imported("a.nii", bytes).grid;
    EXPECT_EQ(grid.spacing_mm, spacings);
    EXPECT_EQ(grid.origin_lps_mm, (Vec3{-10, -20, 30}));
    const Matrix3& direction = grid.direction_lps;
    for (std::size_t row = 0; row < 3; ++row) {
      for (std::size_t column = 0; column < 3; ++column) {
        // Equal to float rounding, and orthonormal in doubles.
        EXPECT_NEAR(direction[3 * row + column], (row < 2 ? -1 : 1) * ras[3 * row + column], 2e-7);
        double product = 0;
        for (std::size_t k = 0; k < 3; ++k) product += direction[3 * k + row] * direction[3 * k + column];
        EXPECT_NEAR(product, row == column ? 1 : 0, 1e-14);
      }
    }
  }
}

/// Column i leans towards j by a thousandth.
TEST_F(ImportImage, KeepsTheShearOfAnSform) {
  const Grid grid = imported("a.nii", with_number<float>(nifti(), 296, 1e-3f)).grid;
  EXPECT_NEAR(grid.direction_lps[0], -1, 1e-6);
  EXPECT_NEAR(grid.direction_lps[3], -1e-3, 1e-9);
  EXPECT_EQ(grid.direction_lps[4], -1);
}

/// 2^40 bytes in a file whose length would allow them.
TEST_F(ImportImage, RefusesMoreVoxelsThanTheMemoryHolds) {
  std::string header = with_number<std::int16_t>(nifti_header(), 70, 64);  // doubles
  header = with_number<std::int16_t>(header, 72, 64);
  for (std::size_t axis = 0; axis < 3; ++axis)
    header = with_number<std::int16_t>(header, 42 + 2 * axis, axis == 2 ? 512 : 16384);
  const std::string path = folder_.file("a.nii.gz");
  write_bytes(path, deflated(header, true));
  std::filesystem::resize_file(path, std::uintmax_t{1} << 30);
  EXPECT_THAT(import_image_here(path),
              FailsWith(ErrorCode::kLimit, HasSubstr("a.nii.gz: has 1048576 MiB of pixels")));
}

}  // namespace
}  // namespace splatlas

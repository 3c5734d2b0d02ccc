// Volume files as ITK reads them, and NIfTI headers against those of its writer.

#include "preprocess/export/write_image.h"

#include <cmath>
#include <cstring>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/preprocess/itk_volumes.h"
#include "tests/preprocess/random_images.h"
#include "tests/support/committed.h"
#include "tests/support/fails_with.h"
#include "tests/support/file_bytes.h"
#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"

namespace splatlas {
namespace {

const std::array<std::string, 4> kEndings{".nii", ".nii.gz", ".nrrd", ".mha"};

bool is_nifti(const std::string& ending) {
  return ending.starts_with(".nii");
}

/// Spacings relative; origins in mm.
double max_difference(const Grid& a, const Grid& b) {
  double difference = 0;
  for (std::size_t n = 0; n < 3; ++n) {
    difference = std::max(difference, std::abs(a.spacing_mm[n] / b.spacing_mm[n] - 1));
    difference = std::max(difference, std::abs(a.origin_lps_mm[n] - b.origin_lps_mm[n]));
  }
  for (std::size_t n = 0; n < 9; ++n)
    difference = std::max(difference, std::abs(a.direction_lps[n] - b.direction_lps[n]));
  return difference;
}

/// Grids of all kinds; the 48 axis orders have all flips and both handednesses.
std::vector<Grid> grids() {
  std::vector<Grid> grids{awkward_grid(0), awkward_grid(3.1)};  // the second is nearly half a turn
  for (const AxisOrder& order : all_axis_orders()) grids.push_back(reordered(awkward_grid(0.3), order));
  for (const Index3& size :
       {Index3{1, 5, 4}, Index3{7, 1, 4}, Index3{7, 5, 1}, Index3{1, 1, 4}, Index3{1, 1, 1}}) {
    grids.push_back(awkward_grid(0.3));
    grids.back().size = size;
  }
  grids.push_back(awkward_grid(-0.7));
  grids.back().spacing_mm = {0.01, 1, 40};
  return grids;
}

TEST(WriteImage, ItkReadsTheSameVoxelsAndGrid) {
  std::mt19937 random(3);
  for (const std::string& ending : kEndings) {
    const TemporaryFolder folder;  // ITK would read v.nii for v.nii.gz
    const std::vector<Grid> all = grids();
    for (std::size_t n = 0; n < all.size(); ++n) {
      const Grid& grid = all[n];
      // Every type in the first grid, every grid in one type
      for (std::size_t t = 0; t < (n == 0 ? kVoxelTypes.size() : 1); ++t) {
        const VoxelType type = kVoxelTypes[(n + t) % kVoxelTypes.size()];
        const Image image = random_volume(grid, type, random);
        const std::string path = folder.file("v" + ending);
        value_or_throw(committed(write_image(image, path)));
        for (const Image& back : {read_by_itk(path), *import_image(path)}) {
          ASSERT_EQ(back.voxels, image.voxels) << ending << " " << name_of(type);
          ASSERT_EQ(message_of(check_same_grid(grid, "written", back.grid, "read")), "");
          // Floats have 24 bits. Doubles of NRRD are multiplied by the spacing and divided again.
          const double max = is_nifti(ending) ? 4e-6 : ending == ".nrrd" ? 1e-15 : 0;
          ASSERT_LE(max_difference(grid, back.grid), max) << ending;
        }
      }
    }
    EXPECT_THAT(folder.names(), ElementsAre("v" + ending));
  }
}

TEST(WriteImage, CompressedVoxelsOfSeveralPieces) {
  std::mt19937 random(4);
  Grid grid = awkward_grid(0);
  grid.size = {101, 67, 83};
  const Image noise = random_volume(grid, VoxelType::kFloat64, random);
  const Image empty = zeros(grid, VoxelType::kInt16);
  for (const std::string& ending : kEndings) {
    const TemporaryFolder folder;
    const std::string path = folder.file("v" + ending);
    for (const Image* image : {&noise, &empty}) {
      ASSERT_TRUE(committed(write_image(*image, path)));
      EXPECT_EQ(read_by_itk(path).voxels, image->voxels) << ending;
      EXPECT_EQ(import_image(path)->voxels, image->voxels) << ending;
    }
    EXPECT_TRUE(ending == ".nii" || std::filesystem::file_size(path) < 20'000);  // of 1.1 MB
  }
}

TEST(WriteImage, KeepsNanAndInfinitiesBitByBit) {
  const TemporaryFolder folder;
  const auto special = [&]<typename T>(T, VoxelType type) {
    using Limits = std::numeric_limits<T>;
    const std::array<T, 8> values{Limits::quiet_NaN(), -Limits::quiet_NaN(), Limits::infinity(),
                                  -Limits::infinity(), Limits::denorm_min(), T{-0.0},
                                  Limits::max(),       Limits::lowest()};
    Image image = zeros({.size = {2, 2, 2}}, type);
    std::memcpy(image.voxels.bytes.data(), values.data(), sizeof(values));
    for (const std::string& ending : kEndings) {
      ASSERT_TRUE(committed(write_image(image, folder.file("v" + ending))));
      EXPECT_EQ(import_image(folder.file("v" + ending))->voxels, image.voxels) << ending;
    }
  };
  special(float{}, VoxelType::kFloat32);
  special(double{}, VoxelType::kFloat64);
}

/// Expects an error with `text`, and no file.
void refuses(const Grid& grid, const std::string& ending, const std::string& text) {
  const TemporaryFolder folder;
  const std::string path = folder.file("v" + ending);
  EXPECT_THAT(committed(write_image(zeros(grid, VoxelType::kUInt8), path)),
              FailsWith(ErrorCode::kFailed, AllOf(HasSubstr(path + ": "), HasSubstr(text))));
  EXPECT_THAT(folder.names(), IsEmpty());
}

/// Expects the geometry in NRRD and MetaImage files, and that NIfTI files cannot hold it.
void fits_doubles_only(const Grid& grid) {
  for (const std::string& ending : kEndings) {
    if (is_nifti(ending)) {
      refuses(grid, ending, "this format cannot hold the volume's geometry; write .nrrd");
      continue;
    }
    const TemporaryFolder folder;
    const std::string path = folder.file("v" + ending);
    EXPECT_EQ(message_of(committed(write_image(zeros(grid, VoxelType::kUInt8), path))), "");
    EXPECT_EQ(message_of(check_same_grid(grid, "written", import_image(path)->grid, "read")), "") << ending;
  }
}

TEST(WriteImage, RefusesGeometryBeyondSinglePrecision) {
  Grid far = awkward_grid(0.3);
  far.spacing_mm = {0.001, 0.001, 0.001};
  far.origin_lps_mm = {1e6 + 1.0 / 3, 0, 0};  // floats are 0.06 mm apart
  fits_doubles_only(far);
}

/// An sform holds any axes; a qform, at byte 252, holds rotations alone.
TEST(WriteImage, HoldsAxesThatAreNotOrthonormal) {
  Grid sheared = awkward_grid(0.3), longer = sheared;
  for (const std::size_t row : {0, 1, 2}) {
    sheared.direction_lps[3 * row] += 0.1 * sheared.direction_lps[3 * row + 1];
    longer.direction_lps[3 * row] *= 1.5;
  }
  const TemporaryFolder folder;
  for (const Grid& grid : {sheared, longer}) {
    for (const std::string& ending : kEndings) {
      const std::string path = folder.file("v" + ending);
      EXPECT_EQ(message_of(committed(write_image(zeros(grid, VoxelType::kUInt8), path))), "");
      EXPECT_EQ(message_of(check_same_grid(grid, "written", import_image(path)->grid, "read")), "") << ending;
    }
    EXPECT_EQ(read_bytes(folder.file("v.nii"))[252], 0);
  }
}

TEST(WriteImage, RefusesCoordinatesThatCannotBeReadBack) {
  Grid far = awkward_grid(0.3);
  far.spacing_mm = {1e6, 1e6, 1e6};
  far.origin_lps_mm[1] = -2e9;
  for (const std::string& ending : kEndings)
    refuses(far, ending, "geometry has -2e+09 mm; files can hold at most 1e9 mm");
  far.origin_lps_mm[1] = -1e9;
  far.spacing_mm = {1e9, 1e9, 1e9};
  for (const std::string& ending : kEndings) {
    const TemporaryFolder folder;
    const std::string path = folder.file("v" + ending);
    EXPECT_EQ(message_of(committed(write_image(zeros(far, VoxelType::kUInt8), path))), "");
    EXPECT_EQ(message_of(check_same_grid(far, "written", import_image(path)->grid, "read")), "") << ending;
  }
}

/// Readers refuse numbers below 1e-37.
TEST(WriteImage, TinyCoordinatesAreZeros) {
  Grid grid;
  grid.size = {3, 3, 3};
  grid.direction_lps = {1, 1e-40, -1e-300, -1e-37, 1, 0, 0, -0.0, 1};
  grid.origin_lps_mm = {1e-40, -1e-308, -0.0};
  for (const std::string& ending : kEndings) {
    const TemporaryFolder folder;
    const std::string path = folder.file("v" + ending);
    EXPECT_EQ(message_of(committed(write_image(zeros(grid, VoxelType::kUInt8), path))), "");
    const Image back = value_or_throw(import_image(path));
    EXPECT_EQ(back.grid.direction_lps, Grid{}.direction_lps);
    EXPECT_EQ(back.grid.origin_lps_mm, Vec3{});
  }
}

TEST(WriteImage, NiftiHasAtMost32767VoxelsAlongAnAxis) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Grid grid{.size = {1, 1, 1}};
    for (const std::string& ending : kEndings) {
      grid.size[axis] = 32768;
      if (is_nifti(ending)) {
        const std::array<const char*, 3> sizes{"32768 x 1 x 1", "1 x 32768 x 1", "1 x 1 x 32768"};
        refuses(grid, ending,
                std::string("this format cannot hold ") + sizes[axis] +
                    " voxels: at most 32767 along an axis; write .nrrd");
        grid.size[axis] = 32767;
      }
      const TemporaryFolder folder;
      const std::string path = folder.file("v" + ending);
      EXPECT_EQ(message_of(committed(write_image(zeros(grid, VoxelType::kUInt8), path))), "");
      EXPECT_EQ(import_image(path)->grid.size, grid.size);
    }
  }
}

/// Files are equal byte by byte: header, voxels and compression.
TEST(NiftiHeader, EqualsItks) {
  const TemporaryFolder folder;
  std::mt19937 random(1);
  for (const double angle : {0.0, 0.3, -1.2, 3.1}) {
    for (const AxisOrder& order : all_axis_orders()) {
      const Grid grid = reordered(awkward_grid(angle), order);
      for (const VoxelType type : {kVoxelTypes[random() % 8], kVoxelTypes[random() % 8]}) {
        const Image image = random_volume(grid, type, random);
        for (const std::string ending : {".nii", ".nii.gz"}) {
          ASSERT_EQ(message_of(committed(write_image(image, folder.file("ours" + ending)))), "");
          write_by_itk(image, folder.file("itk" + ending));
          ASSERT_EQ(read_bytes(folder.file("ours" + ending)), read_bytes(folder.file("itk" + ending)))
              << name_of(type) << " at " << angle << ending;
        }
      }
    }
  }
}

double log_uniform(double low, double high) {
  const double share = static_cast<double>(*rc::gen::inRange(0, 1'000'001)) / 1e6;
  return low * std::pow(high / low, share);
}

/// A rotation by a quaternion of small integers, so that exact half and quarter turns are frequent.
Matrix3 any_rotation() {
  std::array<double, 4> q;
  double length = 0;
  for (double& x : q) {
    x = *rc::gen::inRange(-3, 4) + *rc::gen::element(0.0, 0.0, 1e-3, 1e-5);
    length += x * x;
  }
  RC_PRE(length > 0);
  for (double& x : q) x /= std::sqrt(length);
  const auto [a, b, c, d] = q;
  return {a * a + b * b - c * c - d * d, 2 * (b * c - a * d),           2 * (b * d + a * c),
          2 * (b * c + a * d),           a * a + c * c - b * b - d * d, 2 * (c * d - a * b),
          2 * (b * d - a * c),           2 * (c * d + a * b),           a * a + d * d - b * b - c * c};
}

/// Headers are those of ITK, from large to tiny voxels, where its reader finds the grid again.
RC_GTEST_PROP(NiftiHeaderProperty, IsItksWhereItkHoldsTheGrid, ()) {
  Grid grid;
  for (std::size_t a = 0; a < 3; ++a) {
    grid.size[a] = *rc::gen::element<std::int64_t>(1, 2, 3, 50, *rc::gen::inRange<std::int64_t>(1, 1000));
    grid.spacing_mm[a] = *rc::gen::element(1.0, log_uniform(1e-4, 1e4), log_uniform(0.01, 10));
    grid.origin_lps_mm[a] = *rc::gen::element(0.0, 1.0, -1.0) * log_uniform(1e-3, 1e6);
  }
  grid.direction_lps = any_rotation();
  grid = reordered(grid, *rc::gen::elementOf(all_axis_orders()));
  while (grid.voxels() > 30'000) *std::ranges::max_element(grid.size) /= 2;
  RC_PRE(validate(grid, "grid").has_value());

  const TemporaryFolder folder;
  write_by_itk(zeros(grid, VoxelType::kUInt8), folder.file("itk.nii"));
  const Grid itks = read_by_itk(folder.file("itk.nii")).grid;
  const Result<std::string> header = nifti_header(grid, VoxelType::kUInt8, "ours.nii");
  const bool itk_holds_it = check_same_grid(grid, "", itks, "").has_value();
  RC_TAG(header.has_value(), itk_holds_it);
  // Rounding differs by voxels of the shortest side
  const auto [least, most] = std::ranges::minmax(grid.spacing_mm);
  RC_ASSERT(header.has_value() || !itk_holds_it || most > 100 * least);
  if (header && itk_holds_it)
    RC_ASSERT(*header == read_bytes(folder.file("itk.nii")).substr(0, header->size()));
}

/// Other formats hold every grid.
RC_GTEST_PROP(WriteImageProperty, RandomVolumesComeBack, ()) {
  std::mt19937 random(static_cast<std::mt19937::result_type>(*rc::gen::inRange(0, 1 << 30)));
  Grid grid;
  for (std::size_t a = 0; a < 3; ++a) {
    grid.size[a] = *rc::gen::inRange<std::int64_t>(1, 12);
    grid.spacing_mm[a] = log_uniform(1e-6, 1e6);
    grid.origin_lps_mm[a] = *rc::gen::element(0.0, 1.0, -1.0) * log_uniform(1e-6, 1e6);
  }
  grid.direction_lps = any_rotation();
  const Image image = random_volume(grid, *rc::gen::elementOf(kVoxelTypes), random);
  const TemporaryFolder folder;
  const std::string path = folder.file("v" + *rc::gen::element<std::string>(".nrrd", ".mha"));
  RC_ASSERT(message_of(committed(write_image(image, path))) == "");
  const Result<Image> back = import_image(path);
  RC_ASSERT(message_of(back) == "");
  RC_ASSERT(back->voxels == image.voxels);
  RC_ASSERT(message_of(check_same_grid(grid, "written", back->grid, "read")) == "");
}

}  // namespace
}  // namespace splatlas

// NIfTI headers against those of ITK's writer.
#include <cmath>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "preprocess/export/write_image.h"
#include "tests/preprocess/itk_volumes.h"
#include "tests/preprocess/random_images.h"
#include "tests/support/committed.h"
#include "tests/support/file_bytes.h"
#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"

namespace splatlas {
namespace {

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

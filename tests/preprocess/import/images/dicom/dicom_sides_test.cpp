// Left stays left, in DICOM series and segmentations.
#include <algorithm>

#include "tests/preprocess/import/images/dicom/dicom_files.h"
#include "tests/preprocess/import/sides_fixture.h"

namespace splatlas {
namespace {

using DicomSides = Sides;

/// Rows, columns and normal of slices.
std::array<double, 6> in_plane(const PlacedVolume& volume) {
  const auto& [row, column, normal] = volume.axes_lps;
  return {row[0], row[1], row[2], column[0], column[1], column[2]};
}

TEST_F(DicomSides, OfDicomSeries) {
  constexpr Index3 kSize{TestSlice::kColumns, TestSlice::kRows, 5};
  for (const AxisOrder& order : all_axis_orders()) {
    for (const Body& body : bodies(order, kSize)) {
      const PlacedVolume volume = placed(body, order);
      const std::filesystem::path folder = folder_.path() / "series";
      std::filesystem::create_directory(folder);
      for (std::size_t k = 0; k < 5; ++k) {
        TestSlice slice;
        slice.axes = in_plane(volume);
        slice.spacing = {volume.spacing_mm[1], volume.spacing_mm[0]};
        for (std::size_t a = 0; a < 3; ++a) {
          slice.position[a] =
              volume.first_lps_mm[a] + static_cast<double>(k) * volume.spacing_mm[2] * volume.axes_lps[2][a];
        }
        const auto first = volume.values.begin() + static_cast<std::ptrdiff_t>(k * TestSlice::kPixels);
        slice.stored.assign(first, first + TestSlice::kPixels);
        write_slice(slice, folder / fmt::format("{}", k));
      }
      expect_sides(folder, body);
      if (HasFailure()) FAIL() << name_of(order);
    }
  }
}

TEST_F(DicomSides, OfDicomSegmentations) {
  constexpr Index3 kSize{TestSegmentation::kColumns, TestSegmentation::kRows, 6};
  constexpr std::size_t kPixels = TestSegmentation::kPixels;
  for (const AxisOrder& order : all_axis_orders()) {
    for (Body& body : bodies(order, kSize)) {
      body.spacing_mm[order.from[0]] = body.spacing_mm[order.from[1]] =
          1;  // write_segmentation() has no other
      const PlacedVolume volume = placed(body, order);
      TestSegmentation segmentation;
      segmentation.axes = in_plane(volume);
      segmentation.origin = volume.first_lps_mm;
      segmentation.normal = volume.axes_lps[2];
      segmentation.slice_spacing = volume.spacing_mm[2];
      segmentation.segments = {
          {1, "left", {}, "", "", ""}, {2, "front", {}, "", "", ""}, {3, "top", {}, "", "", ""}};
      for (std::size_t frame = 0; frame < 18; ++frame) {
        const std::size_t k = frame % 6, mark = 1 + frame / 6;
        std::vector<std::uint16_t> mask(kPixels);
        for (std::size_t v = 0; v < kPixels; ++v) mask[v] = volume.values[k * kPixels + v] == mark;
        if (std::ranges::count(mask, 1) == 0) continue;
        segmentation.frames.push_back(
            {static_cast<int>(mark), static_cast<double>(k) * volume.spacing_mm[2], std::move(mask)});
      }
      write_segmentation(segmentation, folder_.file("seg"));
      expect_sides(folder_.file("seg"), body);
      if (HasFailure()) FAIL() << name_of(order);
    }
  }
}

}  // namespace
}  // namespace splatlas

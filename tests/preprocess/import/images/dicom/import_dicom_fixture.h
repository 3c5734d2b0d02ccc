// Fixture of DICOM tests: a folder of slices with known values.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "preprocess/import/images/pixels/image_readers.h"
#include "tests/preprocess/import/images/dicom/dicom_files.h"
#include "tests/preprocess/messages_of_notes.h"
#include "tests/support/fails_with.h"
#include "tests/support/temporary_folder.h"

namespace splatlas {

inline constexpr DicomTag kSeriesUidTag{0x0020, 0x000e}, kSeriesNumberTag{0x0020, 0x0011},
    kSlopeTag{0x0028, 0x1053}, kInterceptTag{0x0028, 0x1052}, kTimeTag{0x0020, 0x0100};

class ImportDicom : public testing::Test {
 protected:
  /// Pixel v of slice k is 100 k + v.
  static std::vector<std::uint16_t> ramp(int k) {
    std::vector<std::uint16_t> stored(TestSlice::kPixels);
    for (std::size_t v = 0; v < stored.size(); ++v)
      stored[v] = static_cast<std::uint16_t>(100 * k + static_cast<int>(v));
    return stored;
  }

  /// Slice k of an axial series at (-1, 2, 10 + 2 k).
  static TestSlice axial(int k) {
    TestSlice slice;
    slice.position = {-1, 2, 10. + 2 * k};
    slice.stored = ramp(k);
    return slice;
  }

  /// Five slices whose names are in the opposite order of their positions.
  void write_series() {
    for (int k = 0; k < 5; ++k) write_slice(axial(k), file(fmt::format("slice{}", 9 - k)));
  }

  [[nodiscard]] std::filesystem::path file(const std::string& name) const { return folder_.path() / name; }
  [[nodiscard]] Result<SourceImage> import(const std::string& series = "") const {
    return import_dicom(folder_.path(), {series, {}});
  }
  [[nodiscard]] SourceImage imported(const std::string& series = "") const {
    return value_or_throw(import(series));
  }

  /// Voxels are int16 and those of ramp(first), ramp(first + 1), ...
  static void expect_ramps(const SourceImage& image, int slices, int first = 0) {
    ASSERT_EQ(image.voxels.type, VoxelType::kInt16);
    ASSERT_EQ(image.voxels.bytes.size(), 2 * TestSlice::kPixels * static_cast<std::size_t>(slices));
    for (int k = 0; k < slices; ++k) {
      for (std::size_t v = 0; v < TestSlice::kPixels; ++v)
        ASSERT_EQ(image.voxels.as<std::int16_t>()[static_cast<std::size_t>(k) * TestSlice::kPixels + v],
                  100 * (first + k) + static_cast<int>(v));
    }
  }

  static std::vector<std::string> notes_of(const SourceImage& image) { return messages_of(image.notes); }

  TemporaryFolder folder_;
};

}  // namespace splatlas

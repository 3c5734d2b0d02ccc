// Fixture for imports of images from bytes.
#pragma once

#include <cstring>
#include <stdexcept>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "preprocess/import/images/import_image.h"
#include "tests/preprocess/raw_image_files.h"
#include "tests/support/temporary_folder.h"

namespace splatlas {

/// import_image() without a child, for long series: a sanitized child takes tens of milliseconds.
inline Result<Image> import_image_here(const std::filesystem::path& path) {
  const ImageFormatEntry* const format = find_image_format(path);
  if (format == nullptr) return import_image(path);  // refuses it
  Result<SourceImage> source = format->read(path, {});
  if (!source) return tl::unexpected(source.error());
  if (source->layers > 1) return import_image(path);  // refuses it
  return Image{source->grid, std::move(source->voxels)};
}

class ImportImage : public testing::Test {
 protected:
  Result<Image> import_bytes(const std::string& name, const std::string& bytes) const {
    write_bytes(folder_.file(name), bytes);
    return import_image_here(folder_.file(name));
  }
  /// Throws std::runtime_error with the library's message.
  Image imported(const std::string& name, const std::string& bytes) const {
    Result<Image> image = import_bytes(name, bytes);
    if (!image) throw std::runtime_error(image.error().message);
    return *std::move(image);
  }
  /// Expects an error of one line that names the file and contains `text`.
  void refuses(const std::string& name, const std::string& bytes, const std::string& text) const {
    const Result<Image> image = import_bytes(name, bytes);
    ASSERT_FALSE(image) << name << " should be refused: " << text;
    EXPECT_THAT(image.error().message, testing::HasSubstr(text));
    EXPECT_THAT(image.error().message, testing::HasSubstr(name));
    EXPECT_THAT(image.error().message, testing::Not(testing::HasSubstr("\n")));
  }
  TemporaryFolder folder_;
};

inline void expect_raw_image(const Image& image) {
  EXPECT_EQ(image.grid.size, (Index3{8, 4, 2}));
  EXPECT_EQ(image.grid.spacing_mm, (Vec3{1, 2, 3}));
  ASSERT_EQ(image.voxels.type, VoxelType::kInt16);
  const auto expected = RawImage::voxels();
  ASSERT_EQ(image.voxels.bytes.size(), expected.size() * 2);
  EXPECT_EQ(std::memcmp(image.voxels.bytes.data(), expected.data(), image.voxels.bytes.size()), 0);
}

}  // namespace splatlas

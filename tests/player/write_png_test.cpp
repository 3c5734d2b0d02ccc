#include "player/write_png.h"

#include <fstream>
#include <iterator>

#include <gmock/gmock.h>
#include <png.h>

#include "tests/support/fails_with.h"
#include "tests/support/temporary_folder.h"

namespace splatlas {
namespace {

/// Ramps of all channels, wider than high, so that rows and columns differ.
Picture ramps() {
  Picture picture{{19, 7}, {}};
  for (int n = 0; n < 19 * 7; ++n) {
    const float alpha = static_cast<float>(n) / 132;
    for (const float share : {1.f, 0.5f, 0.1f}) picture.rgba.push_back(alpha * share);
    picture.rgba.push_back(alpha);
  }
  return picture;
}

struct Decoded {
  png_image image{};
  std::vector<std::uint8_t> pixels;
};

Decoded decode(const std::vector<std::byte>& bytes) {
  Decoded decoded;
  decoded.image.version = PNG_IMAGE_VERSION;
  EXPECT_NE(png_image_begin_read_from_memory(&decoded.image, bytes.data(), bytes.size()), 0);
  decoded.pixels.resize(PNG_IMAGE_SIZE(decoded.image));
  EXPECT_NE(png_image_finish_read(&decoded.image, nullptr, decoded.pixels.data(), 0, nullptr), 0);
  return decoded;
}

TEST(WritePng, KeepsEveryPixelOverABackground) {
  const Picture picture = ramps();
  const Decoded decoded = decode(encode_png(picture, Rgb{10, 120, 250}).value());
  EXPECT_EQ(decoded.image.width, 19u);
  EXPECT_EQ(decoded.image.height, 7u);
  EXPECT_EQ(decoded.image.format, static_cast<png_uint_32>(PNG_FORMAT_RGB));
  EXPECT_EQ(decoded.pixels, to_srgb8(picture, {10, 120, 250}));
}

TEST(WritePng, KeepsAlphaWithoutABackground) {
  const Picture picture = ramps();
  const Decoded decoded = decode(encode_png(picture).value());
  EXPECT_EQ(decoded.image.format, static_cast<png_uint_32>(PNG_FORMAT_RGBA));
  EXPECT_EQ(decoded.pixels, to_srgba8(picture));
}

TEST(WritePng, TheFileIsWhatIsEncoded) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "ramps.png";
  ASSERT_TRUE(write_png(ramps(), path, Rgb{0, 0, 0}));
  std::ifstream file(path, std::ios::binary);
  const std::vector<char> written{std::istreambuf_iterator<char>(file), {}};
  const std::vector<std::byte> encoded = encode_png(ramps(), Rgb{0, 0, 0}).value();
  ASSERT_EQ(written.size(), encoded.size());
  EXPECT_TRUE(std::equal(written.begin(), written.end(), reinterpret_cast<const char*>(encoded.data())));
  EXPECT_THAT(folder.names(), testing::ElementsAre("ramps.png"));
}

TEST(WritePng, SizesBeyondItsNumbersAreTold) {
  EXPECT_TRUE(check_png_size({32768, 32768}, false));
  EXPECT_TRUE(check_png_size({32768, 32767}, true));
  EXPECT_THAT(check_png_size({32768, 32768}, true), FailsWith(ErrorCode::kUsage, HasSubstr("32768x32768")));
}

TEST(WritePng, NamesTheFileThatCannotBeWritten) {
  const TemporaryFolder folder;
  EXPECT_THAT(write_png(ramps(), folder.path() / "none" / "ramps.png"),
              FailsWith(ErrorCode::kFailed, HasSubstr("none/ramps.png")));
  EXPECT_THAT(folder.names(), IsEmpty());
}

TEST(WritePng, NamesThePictureThatCannotBeEncoded) {
  const TemporaryFolder folder;
  EXPECT_THAT(write_png(Picture{}, folder.path() / "empty.png"),
              FailsWith(ErrorCode::kFailed, HasSubstr("empty.png: cannot be encoded: ")));
  EXPECT_THAT(folder.names(), IsEmpty());
}

}  // namespace
}  // namespace splatlas

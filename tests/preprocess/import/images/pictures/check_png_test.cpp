// PNG files that are cut or damaged, which libpng answers by ending the process: a child.
#include <cstdint>

#include <zlib.h>

#include "preprocess/import/images/import_image.h"
#include "tests/preprocess/import/images/import_image_fixture.h"
#include "tests/support/fails_with.h"

namespace splatlas {
namespace {

const std::string kSignature = "\x89PNG\r\n\x1a\n";
/// Of grey pixels of 8 bits.
std::string header_chunk(std::uint32_t columns = 3, std::uint32_t rows = 2) {
  return png_chunk("IHDR", big_endian(columns) + big_endian(rows) + std::string("\x8\0\0\0\0", 5));
}
std::string pixel_chunk() {
  return png_chunk("IDAT", deflated(std::string("\0\1\2\3\0\4\5\6", 8), false));
}

TEST_F(ImportImage, EveryDamageOfAPngFileIsToldInOneLine) {
  const ImageOptions options{.spacing_mm = Vec3{1, 1, 1}};
  const std::string path = folder_.file("a.png");
  const auto refusal = [&](const std::string& bytes) {
    write_bytes(path, bytes);
    const Result<SourceImage> image = read_image(path, options);
    return image ? "no error" : image.error().message;
  };
  const std::string whole = kSignature + header_chunk() + pixel_chunk() + png_chunk("IEND", "");
  ASSERT_EQ(refusal(whole), "no error");
  const Result<SourceImage> image = read_image(path, options);
  ASSERT_EQ(image->voxels.bytes.size(), 6u);
  for (std::size_t v = 0; v < 6; ++v) EXPECT_EQ(image->voxels.as<std::uint8_t>()[v], v + 1);
  for (std::size_t length = 0; length < whole.size(); ++length)
    EXPECT_THAT(refusal(whole.substr(0, length)), StartsWith(path + ": ")) << length;
  // The signature is checked as such; every other byte has a checksum, or is one.
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string damaged = whole;
    damaged[at] ^= 0x10;
    EXPECT_THAT(refusal(damaged), StartsWith(path + ": ")) << at;
  }
  EXPECT_THAT(refusal(kSignature + header_chunk() + png_chunk("IEND", "")), StartsWith(path + ": "));
  EXPECT_THAT(refusal(kSignature + pixel_chunk()), StartsWith(path + ": "));
  EXPECT_THAT(refusal(kSignature + header_chunk(999999, 999999) + pixel_chunk() + png_chunk("IEND", "")),
              HasSubstr("a.png: has 953672 MiB of pixels, and its reader may hold"));
}

}  // namespace
}  // namespace splatlas

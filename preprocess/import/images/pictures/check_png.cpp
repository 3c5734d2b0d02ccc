#include "preprocess/import/images/pictures/check_png.h"

#include <array>
#include <cstdint>
#include <fstream>
#include <string>
#include <string_view>

#include <zlib.h>

#include "preprocess/import/import_error.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kSignature("\x89PNG\r\n\x1a\n", 8);

std::uint32_t big_endian(const char* bytes) {
  std::uint32_t value = 0;
  for (int n = 0; n < 4; ++n) value = value << 8 | static_cast<unsigned char>(bytes[n]);
  return value;
}

}  // namespace

/// Chunks: length, type, data, checksum of type and data (PNG specification, 5.3).
Result<void> check_png(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::array<char, 8> head{};
  if (!file.read(head.data(), head.size()) || std::string_view(head.data(), head.size()) != kSignature)
    return bad_file(path, "is no PNG file");
  std::error_code error;
  std::uint64_t left = fs::file_size(path, error) - kSignature.size();
  std::string type, chunk;
  for (bool has_pixels = false; type != "IEND"; has_pixels = has_pixels || type == "IDAT") {
    if (error || left < 12 || !file.read(head.data(), head.size())) return bad_file(path, "is cut short");
    const std::uint64_t length = big_endian(head.data());
    const bool is_first = type.empty();
    type.assign(&head[4], 4);
    if (is_first && (type != "IHDR" || length != 13)) return bad_file(path, "does not begin as a PNG file");
    if (type == "IEND" && !has_pixels) return bad_file(path, "holds no pixels");
    if (left - 12 < length) return bad_file(path, "is cut short");
    left -= 12 + length;
    chunk.resize(length);
    std::array<char, 4> sum{};
    file.read(chunk.data(), static_cast<std::streamsize>(length));
    file.read(sum.data(), sum.size());
    uLong expected = crc32(0, reinterpret_cast<const Bytef*>(&head[4]), 4);
    expected = crc32_z(expected, reinterpret_cast<const Bytef*>(chunk.data()), chunk.size());
    if (!file || big_endian(sum.data()) != expected)
      return bad_file(path, "is damaged (a checksum is wrong)");
  }
  return {};
}

}  // namespace splatlas

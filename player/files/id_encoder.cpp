#include "player/files/id_encoder.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <zlib.h>

#include "format/result_macros.h"
#include "player/files/load_module.h"
#include "player/files/picture_module.h"

namespace splatlas {
namespace {

using FileBytes = std::vector<std::byte>;

std::string lower_ending(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  std::ranges::transform(ending, ending.begin(), [](unsigned char c) { return std::tolower(c); });
  return ending;
}

void append(FileBytes& to, std::span<const unsigned char> bytes) {
  const std::span as_bytes = std::as_bytes(bytes);
  to.insert(to.end(), as_bytes.begin(), as_bytes.end());
}

/// Appends a big-endian number.
void append(std::vector<unsigned char>& to, std::uint32_t number) {
  for (int shift = 24; shift >= 0; shift -= 8) to.push_back(static_cast<unsigned char>(number >> shift));
}

/// Appends a chunk: length, type, data, checksum (PNG specification, 5.3).
void append_chunk(FileBytes& png, std::string_view type, std::span<const unsigned char> data) {
  std::vector<unsigned char> head, check;
  append(head, static_cast<std::uint32_t>(data.size()));
  head.insert(head.end(), type.begin(), type.end());
  uLong checksum = crc32_z(0, head.data() + 4, type.size());
  if (!data.empty()) checksum = crc32_z(checksum, data.data(), data.size());
  append(check, static_cast<std::uint32_t>(checksum));
  append(png, head);
  append(png, data);
  append(png, check);
}

/// Rows as differences to the row above (PNG specification, 9.2, filter Up), compressed.
Result<std::vector<unsigned char>> compressed_rows(const IdImage& ids) {
  const auto width = static_cast<std::size_t>(ids.size.width);
  std::vector<unsigned char> rows, above(2 * width, 0), row(2 * width);
  rows.reserve((2 * width + 1) * static_cast<std::size_t>(ids.size.height));
  for (std::size_t first = 0; first < ids.numbers.size(); first += width) {
    for (std::size_t n = 0; n < width; ++n) {
      row[2 * n] = static_cast<unsigned char>(ids.numbers[first + n] >> 8);
      row[2 * n + 1] = static_cast<unsigned char>(ids.numbers[first + n]);
    }
    rows.push_back(2);
    for (std::size_t n = 0; n < row.size(); ++n)
      rows.push_back(static_cast<unsigned char>(row[n] - above[n]));
    above.swap(row);
  }
  uLongf size = compressBound(rows.size());
  std::vector<unsigned char> compressed(size);
  if (compress2(compressed.data(), &size, rows.data(), rows.size(), 6) != Z_OK)
    return fail(ErrorCode::kFailed, "zlib cannot compress it");
  compressed.resize(size);
  return compressed;
}

Result<FileBytes> encode_png_of_ids(const IdImage& ids) {
  constexpr std::array<unsigned char, 8> kSignature{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  constexpr std::size_t kMaxChunk = std::size_t{1} << 30;
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<unsigned char> rows, compressed_rows(ids));
  std::vector<unsigned char> header;
  append(header, static_cast<std::uint32_t>(ids.size.width));
  append(header, static_cast<std::uint32_t>(ids.size.height));
  header.insert(header.end(), {16, 0, 0, 0, 0});  // 16 bits of grey
  FileBytes png;
  append(png, kSignature);
  append_chunk(png, "IHDR", header);
  for (std::size_t first = 0; first < rows.size(); first += kMaxChunk)
    append_chunk(png, "IDAT", std::span(rows).subspan(first, std::min(kMaxChunk, rows.size() - first)));
  append_chunk(png, "IEND", {});
  return png;
}

Result<FileBytes> encode_exr_of_ids(const IdImage& ids) {
  SPLATLAS_ASSIGN_OR_RETURN(void* const function,
                            load_function(kPictureModule, kEncodePixelsName, "OpenImageIO"));
  const std::vector<std::uint32_t> numbers(ids.numbers.begin(), ids.numbers.end());
  const PixelsToEncode pixels{".exr", ids.size.width, ids.size.height, 1, kNumberPixels, numbers.data(), 0};
  FileBytes bytes;
  const auto take = [](void* context, const void* first, std::size_t size) {
    const auto* const begin = static_cast<const std::byte*>(first);
    static_cast<FileBytes*>(context)->assign(begin, begin + size);
  };
  std::array<char, 512> error{};
  if (reinterpret_cast<EncodePixels>(function)(&pixels, take, &bytes, error.data(), error.size()) != 0)
    return fail(ErrorCode::kFailed, error.data());
  return bytes;
}

}  // namespace

Result<void> check_id_ending(const std::filesystem::path& path) {
  const std::string ending = lower_ending(path);
  if (ending == ".png" || ending == ".exr") return {};
  return fail(ErrorCode::kUsage, fmt::format("{}: unknown ending '{}' of an id image; use .png or .exr",
                                             path.string(), path.extension().string()));
}

Result<FileBytes> encode_ids(const IdImage& ids, const std::filesystem::path& path) {
  SPLATLAS_RETURN_IF_ERROR(check_id_ending(path));
  auto bytes = lower_ending(path) == ".exr" ? encode_exr_of_ids(ids) : encode_png_of_ids(ids);
  if (bytes) return bytes;
  return fail(bytes.error().code,
              fmt::format("{}: cannot be encoded: {}", path.string(), bytes.error().message));
}

}  // namespace splatlas

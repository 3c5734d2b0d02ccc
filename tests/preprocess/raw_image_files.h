// Image files written byte by byte: small, valid and easy to damage.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <zlib.h>

#include "tests/support/file_bytes.h"

namespace splatlas {

/// 8 x 4 x 2 voxels of int16, counting up from -100.
struct RawImage {
  static constexpr std::array<int, 3> kSize{8, 4, 2};
  static constexpr std::size_t kVoxels = 8 * 4 * 2;

  static std::vector<std::int16_t> voxels() {
    std::vector<std::int16_t> values(kVoxels);
    for (std::size_t v = 0; v < kVoxels; ++v)
      values[v] = static_cast<std::int16_t>(static_cast<int>(v) - 100);
    return values;
  }
  static std::string payload() {
    const auto values = voxels();
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(std::int16_t)};
  }
};

/// `bytes` with the number of type T at `offset` replaced.
template <typename T>
std::string with_number(std::string bytes, std::size_t offset, T value) {
  bytes.replace(offset, sizeof(T), reinterpret_cast<const char*>(&value), sizeof(T));
  return bytes;
}

/// `text` with the first `from` replaced, which it must contain.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

/// `bytes` as a gzip file, or a zlib stream.
inline std::string deflated(const std::string& bytes, bool gzip) {
  z_stream stream{};
  deflateInit2(&stream, 6, Z_DEFLATED, gzip ? 15 + 16 : 15, 8, Z_DEFAULT_STRATEGY);
  std::string result(deflateBound(&stream, bytes.size()) + 64, '\0');
  std::string input = bytes;
  stream.next_in = reinterpret_cast<unsigned char*>(input.data());
  stream.avail_in = static_cast<unsigned>(input.size());
  stream.next_out = reinterpret_cast<unsigned char*>(result.data());
  stream.avail_out = static_cast<unsigned>(result.size());
  deflate(&stream, Z_FINISH);
  result.resize(stream.total_out);
  deflateEnd(&stream);
  return result;
}

/// Four bytes, the highest first.
inline std::string big_endian(std::uint32_t value) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift & 0xff);
  return bytes;
}

/// A chunk of a PNG file.
inline std::string png_chunk(const std::string& type, const std::string& data) {
  const std::string checked = type + data;
  const uLong sum =
      crc32(0, reinterpret_cast<const Bytef*>(checked.data()), static_cast<uInt>(checked.size()));
  return big_endian(static_cast<std::uint32_t>(data.size())) + checked +
         big_endian(static_cast<std::uint32_t>(sum));
}

/// A NIfTI-1 header of RawImage with an identity sform in RAS, spacing 1 x 2 x 3 mm; no extension.
inline std::string nifti_header() {
  std::string h(352, '\0');
  h = with_number<std::int32_t>(h, 0, 348);
  const std::array<std::int16_t, 8> dim{3, 8, 4, 2, 1, 1, 1, 1};
  for (std::size_t n = 0; n < 8; ++n) h = with_number(h, 40 + 2 * n, dim[n]);
  h = with_number<std::int16_t>(h, 70, 4);   // int16
  h = with_number<std::int16_t>(h, 72, 16);  // bits
  const std::array<float, 8> pixdim{1, 1, 2, 3, 0, 0, 0, 0};
  for (std::size_t n = 0; n < 8; ++n) h = with_number(h, 76 + 4 * n, pixdim[n]);
  h = with_number<float>(h, 108, 352);       // vox_offset
  h = with_number<float>(h, 112, 1);         // scl_slope
  h = with_number<std::int16_t>(h, 254, 1);  // sform_code
  const std::array<float, 12> sform{1, 0, 0, 10, 0, 2, 0, 20, 0, 0, 3, 30};
  for (std::size_t n = 0; n < 12; ++n) h = with_number(h, 280 + 4 * n, sform[n]);
  h.replace(344, 3, "n+1");
  return h;
}

inline std::string nifti() {
  return nifti_header() + RawImage::payload();
}

/// `extra` lines go ahead of ElementDataFile.
inline std::string meta_header(const std::string& extra = "", const std::string& data_file = "LOCAL") {
  return "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n" + extra +
         "TransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = 10 20 30\nElementSpacing = 1 2 3\nDimSize = 8 4 2\n"
         "ElementType = MET_SHORT\nElementDataFile = " +
         data_file + "\n";
}

inline std::string meta_image() {
  return meta_header("CompressedData = False\n") + RawImage::payload();
}

inline std::string compressed_meta_image() {
  const std::string packed = deflated(RawImage::payload(), false);
  return meta_header(fmt::format("CompressedData = True\nCompressedDataSize = {}\n", packed.size())) + packed;
}

inline std::string nrrd_header(const std::string& encoding = "raw", const std::string& extra = "") {
  return "NRRD0004\ntype: short\ndimension: 3\nspace: left-posterior-superior\nsizes: 8 4 2\n"
         "space directions: (1,0,0) (0,2,0) (0,0,3)\nkinds: domain domain domain\nendian: "
         "little\nencoding: " +
         encoding + "\nspace origin: (10,20,30)\n" + extra + "\n";
}

inline std::string nrrd() {
  return nrrd_header() + RawImage::payload();
}
inline std::string compressed_nrrd() {
  return nrrd_header("gzip") + deflated(RawImage::payload(), true);
}

}  // namespace splatlas

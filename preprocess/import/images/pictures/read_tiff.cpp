#include "preprocess/import/images/pictures/read_tiff.h"

#include <algorithm>
#include <array>
#include <cstdarg>
#include <cstring>
#include <fstream>
#include <memory>
#include <utility>

#include <tiffio.h>

#include "format/result_macros.h"
#include "preprocess/import/images/pixels/check_image_file.h"
#include "preprocess/import/images/pixels/narrow_integers.h"
#include "preprocess/import/import_error.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

using Tiff = std::unique_ptr<TIFF, decltype(&TIFFClose)>;

/// Set by libtiff's messages: it ends a cut file like a whole one.
bool has_fault = false;

/// Size and type of a page.
struct Page {
  std::int64_t columns = 0, rows = 0;
  VoxelType type = VoxelType::kNone;
  WideInteger wide = WideInteger::kNone;
  std::size_t bytes_each = 0;

  friend bool operator==(const Page&, const Page&) = default;
};

template <typename T>
T field(TIFF* tiff, std::uint32_t tag, T otherwise) {
  T value = otherwise;
  return TIFFGetFieldDefaulted(tiff, tag, &value) == 1 ? value : otherwise;
}

Result<Page> page_of(TIFF* tiff, const fs::path& path) {
  const auto samples = field<std::uint16_t>(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
  const auto photometric = field<std::uint16_t>(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
  if (samples != 1 || photometric == PHOTOMETRIC_PALETTE)
    return bad_file(path, "holds colours or a palette; convert it to grey numbers of 8, 16 or 32 bits");
  const auto bits = field<std::uint16_t>(tiff, TIFFTAG_BITSPERSAMPLE, 1);
  const auto format = field<std::uint16_t>(tiff, TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_UINT);
  Page page;
  page.columns = field<std::uint32_t>(tiff, TIFFTAG_IMAGEWIDTH, 0);
  page.rows = field<std::uint32_t>(tiff, TIFFTAG_IMAGELENGTH, 0);
  page.bytes_each = bits / 8;
  const bool is_signed = format == SAMPLEFORMAT_INT, is_float = format == SAMPLEFORMAT_IEEEFP;
  switch (bits) {
    case 8: page.type = is_signed ? VoxelType::kInt8 : VoxelType::kUInt8; break;
    case 16: page.type = is_signed ? VoxelType::kInt16 : VoxelType::kUInt16; break;
    case 32:
      page.type = is_float ? VoxelType::kFloat32 : is_signed ? VoxelType::kInt32 : VoxelType::kUInt32;
      break;
    case 64:
      page.type = is_float ? VoxelType::kFloat64 : VoxelType::kNone;
      if (!is_float) page.wide = is_signed ? WideInteger::kSigned : WideInteger::kUnsigned;
      break;
    default: return bad_file(path, "has pixels of {} bits; 8, 16, 32 and 64 are read", bits);
  }
  if (is_float && bits < 32) return bad_file(path, "has floats of {} bits; 32 and 64 are read", bits);
  return page;
}

/// Strips, or tiles of which parts beyond the page are dropped.
bool read_pixels(TIFF* tiff, const Page& page, std::byte* to) {
  const std::size_t row_bytes = static_cast<std::size_t>(page.columns) * page.bytes_each;
  if (TIFFIsTiled(tiff) == 0) {
    if (static_cast<std::size_t>(TIFFScanlineSize(tiff)) != row_bytes) return false;
    for (std::int64_t row = 0; row < page.rows; ++row) {
      if (TIFFReadScanline(tiff, to + static_cast<std::size_t>(row) * row_bytes,
                           static_cast<std::uint32_t>(row), 0) < 0)
        return false;
    }
    return true;
  }
  const std::int64_t width = field<std::uint32_t>(tiff, TIFFTAG_TILEWIDTH, 0),
                     height = field<std::uint32_t>(tiff, TIFFTAG_TILELENGTH, 0);
  std::vector<std::byte> tile(static_cast<std::size_t>(std::max<tmsize_t>(TIFFTileSize(tiff), 0)));
  if (width < 1 || height < 1 || tile.size() != static_cast<std::size_t>(width * height) * page.bytes_each)
    return false;
  for (std::int64_t top = 0; top < page.rows; top += height) {
    for (std::int64_t left = 0; left < page.columns; left += width) {
      if (TIFFReadTile(tiff, tile.data(), static_cast<std::uint32_t>(left), static_cast<std::uint32_t>(top),
                       0, 0) < 0)
        return false;
      const auto bytes = static_cast<std::size_t>(std::min(width, page.columns - left)) * page.bytes_each;
      for (std::int64_t row = top; row < std::min(top + height, page.rows); ++row) {
        std::memcpy(
            to + static_cast<std::size_t>(row) * row_bytes + static_cast<std::size_t>(left) * page.bytes_each,
            &tile[static_cast<std::size_t>((row - top) * width) * page.bytes_each], bytes);
      }
    }
  }
  return true;
}

/// True if the file ends behind the last directory's link to the next one: libtiff takes a link that is cut
/// off for none.
bool ends_behind_directory(TIFF* tiff, std::uint64_t offset, const fs::path& path) {
  const bool is_big = TIFFIsBigTIFF(tiff) != 0;
  std::array<char, 8> count{};
  std::ifstream file(path, std::ios::binary);
  file.seekg(static_cast<std::streamoff>(offset));
  file.read(count.data(), is_big ? 8 : 2);
  if (TIFFIsByteSwapped(tiff) != 0) std::reverse(count.begin(), count.begin() + (is_big ? 8 : 2));
  std::uint64_t entries = 0;
  std::memcpy(&entries, count.data(), count.size());
  std::error_code error;
  const std::uint64_t size = fs::file_size(path, error);
  return file && !error && offset + (is_big ? 16 + 20 * entries : 6 + 12 * entries) <= size;
}

}  // namespace

Result<SourceImage> read_tiff(const fs::path& path) {
  has_fault = false;
  TIFFSetErrorHandler([](const char*, const char*, std::va_list) { has_fault = true; });
  TIFFSetWarningHandler(nullptr);
  const Tiff tiff(TIFFOpen(path.c_str(), "rm"), TIFFClose);  // m: not mapped, so that a cut file gives errors
  if (!tiff) return bad_file(path, "is not the picture that its ending says");
  SPLATLAS_ASSIGN_OR_RETURN(const Page first, page_of(tiff.get(), path));
  SourceImage image;
  std::vector<std::byte> bytes;
  std::uint64_t directory = 0;  // offset of the page's
  do {
    directory = TIFFCurrentDirOffset(tiff.get());
    SPLATLAS_ASSIGN_OR_RETURN(const Page page, page_of(tiff.get(), path));
    if (page != first)
      return bad_file(path, "has pages of several sizes or types; save each volume as a file of its own");
    image.grid.size = {page.columns, page.rows, image.grid.size[2] + 1};
    SPLATLAS_ASSIGN_OR_RETURN(const std::uint64_t all, payload_bytes(path, image.grid.size, page.bytes_each));
    const std::size_t before = bytes.size();
    bytes.resize(all);
    if (!read_pixels(tiff.get(), page, &bytes[before]))
      return bad_file(path, "page {} is damaged or cut; get the file again", image.grid.size[2]);
  } while (TIFFReadDirectory(tiff.get()) == 1);
  if (has_fault || !ends_behind_directory(tiff.get(), directory, path))
    return bad_file(path, "is damaged or cut behind page {}; get the file again", image.grid.size[2]);
  if (first.wide == WideInteger::kNone) {
    image.voxels = {first.type, std::move(bytes)};
  } else {
    SPLATLAS_ASSIGN_OR_RETURN(image.voxels, narrow_integers(bytes, first.wide, path));
  }
  return image;
}

}  // namespace splatlas

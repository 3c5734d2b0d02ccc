#include <algorithm>
#include <array>
#include <cstdarg>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <memory>
#include <string>
#include <utility>

#include <itkPNGImageIO.h>
#include <nlohmann/json.hpp>
#include <tiffio.h>

#include "format/result_macros.h"
#include "format/text/ascii_text.h"
#include "preprocess/import/images/itk/itk_call.h"
#include "preprocess/import/images/pixels/check_image_file.h"
#include "preprocess/import/images/pixels/image_readers.h"
#include "preprocess/import/images/pixels/read_deflated.h"
#include "preprocess/import/isolation/run_isolated.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

/// Direction in LPS of an axis that begins at a side.
std::optional<Vec3> direction_from(char side) {
  const std::size_t place = std::string_view("rlapis").find(side);
  if (place == std::string_view::npos) return std::nullopt;
  Vec3 direction{0, 0, 0};
  direction[place / 2] = place % 2 == 0 ? 1 : -1;
  return direction;
}

using Tiff = std::unique_ptr<TIFF, decltype(&TIFFClose)>;

/// Set by libtiff's messages: it ends a cut file like a whole one.
bool has_fault = false;

struct Page {
  std::int64_t columns = 0, rows = 0;
  StoredType type;

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
  const bool is_signed = format == SAMPLEFORMAT_INT, is_float = format == SAMPLEFORMAT_IEEEFP;
  switch (bits) {
    case 8: page.type.type = is_signed ? VoxelType::kInt8 : VoxelType::kUInt8; break;
    case 16: page.type.type = is_signed ? VoxelType::kInt16 : VoxelType::kUInt16; break;
    case 32:
      page.type.type = is_float ? VoxelType::kFloat32 : is_signed ? VoxelType::kInt32 : VoxelType::kUInt32;
      break;
    case 64:
      page.type.type = is_float ? VoxelType::kFloat64 : VoxelType::kNone;
      if (!is_float) page.type.wide = is_signed ? WideInteger::kSigned : WideInteger::kUnsigned;
      break;
    default: return bad_file(path, "has pixels of {} bits; 8, 16, 32 and 64 are read", bits);
  }
  if (is_float && bits < 32) return bad_file(path, "has floats of {} bits; 32 and 64 are read", bits);
  return page;
}

/// Strips, or tiles of which parts beyond the page are dropped.
bool read_pixels(TIFF* tiff, const Page& page, std::byte* to) {
  const std::size_t row_bytes = static_cast<std::size_t>(page.columns) * page.type.bytes();
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
  if (width < 1 || height < 1 || tile.size() != static_cast<std::size_t>(width * height) * page.type.bytes())
    return false;
  for (std::int64_t top = 0; top < page.rows; top += height) {
    for (std::int64_t left = 0; left < page.columns; left += width) {
      if (TIFFReadTile(tiff, tile.data(), static_cast<std::uint32_t>(left), static_cast<std::uint32_t>(top),
                       0, 0) < 0)
        return false;
      const auto bytes = static_cast<std::size_t>(std::min(width, page.columns - left)) * page.type.bytes();
      for (std::int64_t row = top; row < std::min(top + height, page.rows); ++row) {
        std::memcpy(to + static_cast<std::size_t>(row) * row_bytes +
                        static_cast<std::size_t>(left) * page.type.bytes(),
                    &tile[static_cast<std::size_t>((row - top) * width) * page.type.bytes()], bytes);
      }
    }
  }
  return true;
}

/// True if the file holds the whole link behind its last directory: libtiff takes one cut off for none.
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

/// Reads all pages as slices, without spacing and orientation. kFailed for colours, palettes, pages of
/// several sizes or types, unsupported types, and damage. Reads BigTIFF and every compression of libtiff.
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
    SPLATLAS_ASSIGN_OR_RETURN(const std::uint64_t all,
                              payload_bytes(path, image.grid.size, page.type.bytes()));
    SPLATLAS_RETURN_IF_ERROR(check_image_memory(path, all));
    const std::size_t before = bytes.size();
    bytes.resize(all);
    if (!read_pixels(tiff.get(), page, &bytes[before]))
      return bad_file(path, "page {} is damaged or cut; get the file again", image.grid.size[2]);
  } while (TIFFReadDirectory(tiff.get()) == 1);
  if (has_fault || !ends_behind_directory(tiff.get(), directory, path))
    return bad_file(path, "is damaged or cut behind page {}; get the file again", image.grid.size[2]);
  SPLATLAS_ASSIGN_OR_RETURN(image.voxels, voxels_of(std::move(bytes), first.type, path));
  return image;
}

/// The name with zeros ahead of its numbers: so it sorts by them.
std::string with_long_numbers(const std::string& name) {
  constexpr std::size_t kDigits = 256;  // no name of a file is longer
  std::string result;
  for (std::size_t at = 0; at < name.size();) {
    const std::size_t end = std::min(name.find_first_not_of("0123456789", at), name.size());
    const std::size_t first = std::min(name.find_first_not_of('0', at), end);
    if (end > at) result.append(kDigits - (end - first), '0').append(name, first, end - first);
    at = end;
    if (at < name.size()) result += name[at++];
  }
  return result;
}

std::vector<fs::path> list_pictures(const fs::path& path) {
  std::error_code error;
  if (!fs::is_directory(path, error)) return {path};
  std::vector<fs::path> files = visible_files(path);
  std::erase_if(files, [](const fs::path& file) { return !is_picture(file); });
  std::ranges::sort(files, {},
                    [](const fs::path& file) { return with_long_numbers(file.filename().string()); });
  return files;
}

Result<SourceImage> read_png(const fs::path& file) {
  const itk::PNGImageIO::Pointer io = itk::PNGImageIO::New();
  if (!io->CanReadFile(file.c_str())) return bad_file(file, "is not the picture that its ending says");
  io->SetFileName(file.string());
  io->ReadImageInformation();
  if (io->GetNumberOfComponents() != 1 || io->GetPixelType() != itk::IOPixelEnum::SCALAR)
    return bad_file(file, "holds colours or a palette; convert it to grey numbers of 8 or 16 bits");
  SourceImage image;
  image.grid.size = {static_cast<std::int64_t>(io->GetDimensions(0)),
                     static_cast<std::int64_t>(io->GetDimensions(1)), 1};
  image.voxels.type = voxel_type_of(io->GetComponentType());
  SPLATLAS_ASSIGN_OR_RETURN(const std::uint64_t bytes,
                            payload_bytes(file, image.grid.size, bytes_of(image.voxels.type)));
  SPLATLAS_RETURN_IF_ERROR(check_image_memory(file, bytes));
  image.voxels.bytes.resize(bytes);
  itk::ImageIORegion region(2);
  for (unsigned a = 0; a < 2; ++a) region.SetSize(a, io->GetDimensions(a));
  io->SetIORegion(region);
  io->Read(image.voxels.bytes.data());
  return image;
}

Result<void> add_picture(const fs::path& file, SourceImage& image) {
  report_child_progress(file);
  const bool is_png = to_lower(file.extension().string()) == ".png";
  SPLATLAS_ASSIGN_OR_RETURN(SourceImage next, is_png ? read_png(file) : read_tiff(file));
  if (image.voxels.empty()) {
    image = std::move(next);
    return {};
  }
  if (next.voxels.type != image.voxels.type || next.grid.size[0] != image.grid.size[0] ||
      next.grid.size[1] != image.grid.size[1]) {
    return bad_file(file, "has {} x {} {} pixels, but the pictures before have {} x {} {}", next.grid.size[0],
                    next.grid.size[1], name_of(next.voxels.type), image.grid.size[0], image.grid.size[1],
                    name_of(image.voxels.type));
  }
  image.grid.size[2] += next.grid.size[2];
  SPLATLAS_ASSIGN_OR_RETURN(const std::uint64_t bytes,
                            payload_bytes(file, image.grid.size, bytes_of(image.voxels.type)));
  SPLATLAS_RETURN_IF_ERROR(check_image_memory(file, bytes));
  image.voxels.bytes.insert(image.voxels.bytes.end(), next.voxels.bytes.begin(), next.voxels.bytes.end());
  return {};
}

}  // namespace

bool is_picture(const fs::path& path) {
  const std::string ending = to_lower(path.extension().string());
  return ending == ".tif" || ending == ".tiff" || ending == ".png";
}

Result<SourceImage> read_pictures(const fs::path& path, const ImageOptions& options) {
  std::optional<PictureFrame> frame;
  if (!options.spacing_mm) {
    SPLATLAS_ASSIGN_OR_RETURN(frame, brainglobe_frame(path));
    if (!frame) {
      return fail(ErrorCode::kUsage,
                  "{}: pictures hold no distances; give the voxels' size in mm: --spacing X,Y,Z",
                  path.string());
    }
  }
  return call_itk(path.string(), [&]() -> Result<SourceImage> {
    SourceImage image;
    for (const fs::path& file : list_pictures(path)) SPLATLAS_RETURN_IF_ERROR(add_picture(file, image));
    if (frame) {
      image.grid.spacing_mm = frame->spacing_mm;
      image.grid.direction_lps = frame->direction_lps;
    } else {
      image.grid.spacing_mm = *options.spacing_mm;
      image.notes.add("no-orientation-pictures", path.string());
    }
    SPLATLAS_RETURN_IF_ERROR(validate(image.grid, path.string()));
    return image;
  });
}

bool is_brainglobe_folder(const fs::path& path) {
  std::error_code error;
  return std::ranges::all_of(std::array{"metadata.json", "annotation.tiff", "structures.json"},
                             [&](const char* name) { return fs::is_regular_file(path / name, error); });
}

Result<std::optional<PictureFrame>> brainglobe_frame(const fs::path& picture) {
  const fs::path folder = picture.has_parent_path() ? picture.parent_path() : fs::path(".");
  if (!is_brainglobe_folder(folder)) return std::nullopt;
  const fs::path file = folder / "metadata.json";
  std::ifstream stream(file);
  const nlohmann::json metadata = nlohmann::json::parse(stream, nullptr, /*allow_exceptions=*/false);
  const auto refuse = [&] {
    return bad_file(
        file, "must have \"resolution\", three numbers in micrometres, and \"orientation\", as \"asr\"");
  };
  if (!metadata.is_object() || !metadata.contains("resolution") || !metadata.contains("orientation"))
    return refuse();
  const nlohmann::json &resolution = metadata["resolution"], &orientation = metadata["orientation"];
  if (!resolution.is_array() || resolution.size() != 3 || !orientation.is_string()) return refuse();
  const auto letters = orientation.get<std::string>();
  if (letters.size() != 3) return refuse();
  PictureFrame frame;
  for (std::size_t axis = 0; axis < 3; ++axis) {  // of the file: pages, rows, columns
    const std::size_t a = 2 - axis;
    const auto direction = direction_from(letters[axis]);
    if (!direction || !resolution[axis].is_number()) return refuse();
    frame.spacing_mm[a] = resolution[axis].get<double>() / 1000;
    for (std::size_t row = 0; row < 3; ++row) frame.direction_lps[3 * row + a] = (*direction)[row];
  }
  if (!(std::abs(determinant(frame.direction_lps)) > 0)) return refuse();
  return frame;
}

}  // namespace splatlas

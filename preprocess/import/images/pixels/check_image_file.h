// Checks of image files before ITK reads them.
//
// ITK's readers accept truncated MetaImage files and follow detached headers to any file of the machine. They
// replace invalid spacings silently, and abort on a NaN in an orientation.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "format/result.h"

namespace splatlas {

/// Maximum magnitude of numbers in a geometry, in mm.
inline constexpr double kMaxPlausible = 1e9;
/// True for numbers that are valid in a geometry: 0, or a magnitude from 1e-37 to kMaxPlausible. ITK's linear
/// algebra aborts on NaN, does not terminate on 1e38, and prints warnings about 1e-40.
[[nodiscard]] inline bool is_plausible(double x) {
  return x == 0 || (std::abs(x) > 1e-37 && std::abs(x) <= kMaxPlausible);
}

enum class Compression : std::uint8_t { kNone, kDeflate, kBzip2 };

/// Location and order of the pixels behind an image header.
struct PixelData {
  std::filesystem::path file = {};
  std::uint64_t start = 0, bytes = 0;            ///< offset in the file, and decompressed length
  std::uint64_t skipped_bytes = 0;               ///< decompressed bytes before the pixels
  Compression compression = Compression::kNone;  ///< else ITK reads the pixels
  bool is_big_endian = false;
  bool is_plain = false;                    ///< uncompressed binary pixels, from `start` on
  std::optional<double> mm_per_unit = 1.0;  ///< nullopt for an unknown unit
  std::size_t layers = 1;
  bool layers_first = false;                   ///< the layers of a voxel stand together
  bool has_no_space = false;                   ///< the axes of an NRRD file have no anatomical meaning
  std::array<bool, 2> misread_axes{};          ///< x and y that ITK leaves with the wrong sign
  std::map<std::string, std::string> pairs{};  ///< key/value pairs of an NRRD header
};

/// Checks a regular NRRD or MetaImage file. kFailed for:
///   - another format, colours, or more than five dimensions,
///   - spacings that are not positive, or numbers that are invalid in a geometry,
///   - fewer bytes than the voxels need at least, or pixels outside the file's folder.
/// Cost: reads the header. read_deflated() checks compressed pixels, and NiftiFile checks NIfTI files.
[[nodiscard]] Result<PixelData> check_nrrd_file(const std::filesystem::path& path);
[[nodiscard]] Result<PixelData> check_meta_image_file(const std::filesystem::path& path);

// Parts of the checks of all formats.

/// A value for messages. Damage may join other lines to it, whose free text may name a patient.
[[nodiscard]] std::string shown(const std::string& value);

/// The pixel file that a detached header names. kFailed for lists of files, for absolute names, for names
/// that leave the header's folder through ".." or a symbolic link, and for anything but a regular file.
[[nodiscard]] Result<std::filesystem::path> pixel_file_beside(const std::filesystem::path& header,
                                                              const std::string& name);

/// Maximum compression ratio; deflate reaches about 1032.
inline constexpr std::uint64_t kMaxDeflateRatio = 1100;

/// Bytes beyond the pixels that are read to reach a compressed stream's checksum.
inline constexpr std::uint64_t kMaxSurplus = 16u << 20;

/// Millimetres of a unit such as "mm", "um" or "microns"; 1 without a text, nullopt for others.
[[nodiscard]] std::optional<double> mm_of_unit(std::string_view unit);

/// The product of sizes and `bytes_per_voxel`. kFailed for sizes below 1 or above kMaxAxisSize and for more
/// than kMaxVoxels voxels, so that no later product overflows.
[[nodiscard]] Result<std::uint64_t> payload_bytes(const std::filesystem::path& path,
                                                  std::span<const std::int64_t> sizes,
                                                  std::uint64_t bytes_per_voxel);
/// kLimit if the bytes of an image's pixels take more than two thirds of this process's memory. A child has
/// half of the machine's; its answer is another copy.
[[nodiscard]] Result<void> check_image_memory(const std::filesystem::path& path, std::uint64_t bytes);
/// kFailed if a file holds less than `needed` bytes from `offset` on. The message states `expected`, the
/// number of decompressed bytes of pixels. Then check_image_memory() of these.
[[nodiscard]] Result<void> check_raw_payload(const std::filesystem::path& path, std::uint64_t offset,
                                             std::uint64_t needed, std::uint64_t expected);

[[nodiscard]] tl::unexpected<Error> truncated_file(const std::filesystem::path& path, std::uint64_t expected,
                                                   std::uint64_t found);
[[nodiscard]] tl::unexpected<Error> bad_pixel_type(const std::filesystem::path& path, std::string_view type);

}  // namespace splatlas

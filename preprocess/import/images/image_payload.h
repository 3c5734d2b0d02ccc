// Location and completeness of the pixels behind an image header.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "format/result.h"

namespace splatlas {

/// The pixel file that a detached header names. kFailed for absolute names, for names that leave the header's
/// folder through ".." or a symbolic link, and for anything but a regular file.
[[nodiscard]] Result<std::filesystem::path> resolve_beside(const std::filesystem::path& header,
                                                           const std::string& name);

/// The product of sizes and `bytes_per_voxel`. kFailed for sizes below 1 or above kMaxAxisSize and for more
/// than kMaxVoxels voxels, so that no later product overflows.
[[nodiscard]] Result<std::uint64_t> payload_bytes(const std::filesystem::path& path,
                                                  std::span<const std::int64_t> sizes,
                                                  std::uint64_t bytes_per_voxel);

/// Maximum compression ratio; deflate reaches about 1032.
inline constexpr std::uint64_t kMaxDeflateRatio = 1100;
/// Bytes beyond the pixels that are read to reach a compressed stream's checksum.
inline constexpr std::uint64_t kMaxSurplus = 16u << 20;

[[nodiscard]] tl::unexpected<Error> truncated_file(const std::filesystem::path& path, std::uint64_t expected,
                                                   std::uint64_t found);

/// kFailed if a file holds less than `needed` bytes from `offset` on. The message states `expected`, the
/// number of decompressed bytes of pixels.
[[nodiscard]] Result<void> check_raw_payload(const std::filesystem::path& path, std::uint64_t offset,
                                             std::uint64_t needed, std::uint64_t expected);
[[nodiscard]] inline Result<void> check_raw_payload(const std::filesystem::path& path, std::uint64_t offset,
                                                    std::uint64_t expected) {
  return check_raw_payload(path, offset, expected, expected);
}

/// kFailed for a zlib or gzip stream at `offset` that is damaged or decompresses to less than `expected`
/// bytes. Cost: one decompression, in constant memory, to at most kMaxSurplus beyond.
[[nodiscard]] Result<void> check_deflated_payload(const std::filesystem::path& path, std::uint64_t offset,
                                                  std::uint64_t expected);

}  // namespace splatlas

// The pixels behind an image header: where they are and whether all of them are there.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "format/result.h"

namespace splatlas {

/// The file that a detached header names. Refuses (kFailed) names that lead out of the header's folder, by
/// "..", from the root, or through a symbolic link, and whatever is not a regular file.
[[nodiscard]] Result<std::filesystem::path> resolve_beside(const std::filesystem::path& header,
                                                           const std::string& name);

/// The product of sizes and `bytes_per_voxel`. Refuses sizes below 1 or above kMaxAxisSize and more than
/// kMaxVoxels voxels, so that nothing later overflows.
[[nodiscard]] Result<std::uint64_t> payload_bytes(const std::filesystem::path& path,
                                                  std::span<const std::int64_t> sizes,
                                                  std::uint64_t bytes_per_voxel);

/// Refuses a file that holds less than `expected` bytes from `offset` on.
[[nodiscard]] Result<void> check_raw_payload(const std::filesystem::path& path, std::uint64_t offset,
                                             std::uint64_t expected);

/// Refuses a zlib or gzip stream at `offset` that is damaged or decompresses to less than `expected` bytes of
/// pixels after `before` other bytes. Cost: one decompression, in constant memory, stopped soon after.
[[nodiscard]] Result<void> check_deflated_payload(const std::filesystem::path& path, std::uint64_t offset,
                                                  std::uint64_t expected, std::uint64_t before = 0);

}  // namespace splatlas

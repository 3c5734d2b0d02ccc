// Decompression and byte order of pixels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "format/content/voxel_type.h"
#include "format/result.h"

namespace splatlas {

/// Decompresses `bytes` bytes from the zlib or gzip stream at `offset`, in one pass. kFailed if it is damaged
/// or too short. Reads at most kMaxSurplus bytes more, for the checksum. Touches memory in proportion to the
/// stream, not to `bytes`.
[[nodiscard]] Result<void> read_deflated(const std::filesystem::path& path, std::uint64_t offset,
                                         std::uint64_t bytes, std::vector<std::byte>& pixels);

/// The same for a bzip2 stream.
[[nodiscard]] Result<void> read_bzip2(const std::filesystem::path& path, std::uint64_t offset,
                                      std::uint64_t bytes, std::vector<std::byte>& pixels);

/// Reverses the byte order of all voxels of `bytes_each` bytes.
void swap_bytes(std::vector<std::byte>& voxels, std::size_t bytes_each);

}  // namespace splatlas

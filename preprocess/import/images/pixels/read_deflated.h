// Decompression, byte order and width of pixels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include <zlib.h>

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

enum class WideInteger : std::uint8_t { kNone, kSigned, kUnsigned };

/// A type of voxels in a file: that of an atlas, or integers of 64 bits, which are narrowed.
struct StoredType {
  VoxelType type = VoxelType::kNone;
  WideInteger wide = WideInteger::kNone;

  [[nodiscard]] std::size_t bytes() const { return wide == WideInteger::kNone ? bytes_of(type) : 8; }
  friend bool operator==(const StoredType&, const StoredType&) = default;
};

/// The voxels that `bytes`, in this machine's byte order, hold. Of 64-bit integers int32 if all values fit,
/// else uint32; kFailed, with the value, if one fits neither.
[[nodiscard]] Result<VoxelBuffer> voxels_of(std::vector<std::byte> bytes, const StoredType& type,
                                            const std::filesystem::path& path);

/// A file open for reading, plain or compressed, of one or several gzip members. Not thread-safe.
class GzipFile {
 public:
  GzipFile() = default;
  /// kFailed if it cannot be opened, or if its compression contradicts its ending (.gz, .mgz, or others).
  [[nodiscard]] static Result<GzipFile> open(const std::filesystem::path& path);

  [[nodiscard]] bool is_compressed() const { return gzdirect(stream_.get()) == 0; }
  /// Reads less than 2 GiB from the current position. Returns the bytes read, fewer at the file's end.
  /// kFailed for damage.
  [[nodiscard]] Result<std::size_t> read_some(std::span<std::byte> bytes);
  /// Reads `count` bytes from an offset of the decompressed file. kFailed if there are fewer.
  [[nodiscard]] Result<std::vector<std::byte>> read(std::uint64_t offset, std::uint64_t count);
  /// Reads a compressed file to its end, at most kMaxSurplus bytes, for its checksum. kFailed for damage.
  [[nodiscard]] Result<void> check_end();

 private:
  struct Close {
    void operator()(gzFile_s* stream) const { gzclose(stream); }
  };

  std::filesystem::path path_;
  std::unique_ptr<gzFile_s, Close> stream_;
};

}  // namespace splatlas

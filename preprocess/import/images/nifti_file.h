// Header and voxels of a NIfTI-1 file.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <memory>

#include <zlib.h>

#include "format/result.h"
#include "format/voxel_type.h"

namespace splatlas {

/// The first 348 bytes of a .nii file (nifti1.h; offsets in bytes), read in the byte order of the file.
class NiftiHeader {
 public:
  static constexpr std::size_t kBytes = 348;

  explicit NiftiHeader(const std::array<char, kBytes>& bytes) : bytes_(bytes) {
    swapped_ = get<std::int32_t>(0) != std::int32_t{kBytes};
  }

  /// True for the header of a single-file NIfTI-1 file.
  [[nodiscard]] bool valid() const {
    return get<std::int32_t>(0) == std::int32_t{kBytes} && std::memcmp(&bytes_[344], "n+1", 4) == 0;
  }
  /// True if the file's byte order differs from this machine's.
  [[nodiscard]] bool swapped() const { return swapped_; }
  /// dim(0) is the number of axes, dim(n) the voxels along axis n = 1...
  [[nodiscard]] std::int16_t dim(std::size_t n) const { return get<std::int16_t>(40 + 2 * n); }
  [[nodiscard]] std::int16_t datatype() const { return get<std::int16_t>(70); }
  /// kNone for unsupported datatypes.
  [[nodiscard]] VoxelType voxel_type() const;
  [[nodiscard]] std::int16_t bits_per_voxel() const { return get<std::int16_t>(72); }
  /// Along axis n = 1...
  [[nodiscard]] float spacing(std::size_t n) const { return get<float>(76 + 4 * n); }
  [[nodiscard]] float voxel_offset() const { return get<float>(108); }
  [[nodiscard]] float slope() const { return get<float>(112); }
  [[nodiscard]] float intercept() const { return get<float>(116); }
  /// True if lengths are in mm or have no unit.
  [[nodiscard]] bool in_mm() const {
    constexpr int kUnknown = 0, kMillimetres = 2, kSpaceBits = 7;
    const int unit = bytes_[123] & kSpaceBits;
    return unit == kUnknown || unit == kMillimetres;
  }
  [[nodiscard]] bool has_qform() const { return get<std::int16_t>(252) > 0; }
  [[nodiscard]] bool has_sform() const { return get<std::int16_t>(254) > 0; }
  /// Row (0 to 2) and column (0 to 3) of the affine from voxel indices to RAS.
  [[nodiscard]] float sform(std::size_t row, std::size_t column) const {
    return get<float>(280 + 16 * row + 4 * column);
  }
  /// All numbers of the qform, then of the sform.
  [[nodiscard]] float orientation(std::size_t n) const { return get<float>(256 + 4 * n); }
  static constexpr std::size_t kOrientationNumbers = 18;

 private:
  template <typename T>
  [[nodiscard]] T get(std::size_t offset) const {
    std::array<char, sizeof(T)> field{};
    std::memcpy(field.data(), &bytes_[offset], sizeof(T));
    if (swapped_) std::reverse(field.begin(), field.end());
    T value;
    std::memcpy(&value, field.data(), sizeof(T));
    return value;
  }

  std::array<char, kBytes> bytes_;
  bool swapped_ = false;
};

/// An open .nii or .nii.gz file with a valid header.
class NiftiFile {
 public:
  /// Reads the header. kFailed for:
  ///   - files that are not single-file NIfTI-1, or whose ending contradicts their compression,
  ///   - files that are too small for their voxels, and more than one volume,
  ///   - spacings that are not positive, or an invalid orientation, value scale or size,
  ///   - unsupported pixel types.
  [[nodiscard]] static Result<NiftiFile> open(const std::filesystem::path& path);

  [[nodiscard]] const NiftiHeader& header() const { return header_; }

  /// Reads all voxels in one pass. Scales them by scl_slope and scl_inter to floats; doubles stay doubles.
  /// kFailed for truncated files, and for compressed files with a wrong checksum. Call it once.
  [[nodiscard]] Result<VoxelBuffer> read_voxels();

 private:
  struct Close {
    void operator()(gzFile_s* stream) const { gzclose(stream); }
  };
  using Stream = std::unique_ptr<gzFile_s, Close>;

  NiftiFile(const std::filesystem::path& path, const NiftiHeader& header, Stream stream)
      : path_(path), header_(header), stream_(std::move(stream)) {}
  Result<void> check_geometry() const;
  Result<void> check_voxels();
  [[nodiscard]] bool is_compressed() const { return gzdirect(stream_.get()) == 0; }
  Result<void> fill(VoxelBuffer& voxels);
  Result<void> check_end();

  std::filesystem::path path_;
  NiftiHeader header_;
  Stream stream_;  // plain or compressed
  std::uint64_t voxel_bytes_ = 0;
};

}  // namespace splatlas

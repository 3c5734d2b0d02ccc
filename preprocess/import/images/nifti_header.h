// The numbers of a NIfTI-1 header.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <optional>

#include "format/voxel_type.h"

namespace splatlas {

/// The first 348 bytes of a .nii file (nifti1.h; offsets in bytes), read in the byte order of the file.
class NiftiHeader {
 public:
  static constexpr std::size_t kBytes = 348;

  explicit NiftiHeader(const std::array<char, kBytes>& bytes);

  /// Whether this is the header of a single-file NIfTI-1 file. Nothing else counts when it is not.
  [[nodiscard]] bool valid() const { return valid_; }
  /// Whether the file's byte order is not this machine's.
  [[nodiscard]] bool swapped() const { return swapped_; }
  /// dim(0) is the number of axes, dim(n) the voxels along axis n = 1...
  [[nodiscard]] std::int16_t dim(std::size_t n) const { return get<std::int16_t>(40 + 2 * n); }
  [[nodiscard]] std::int16_t datatype() const { return get<std::int16_t>(70); }
  /// kNone for datatypes that atlases do not take.
  [[nodiscard]] VoxelType voxel_type() const;
  [[nodiscard]] std::int16_t bits_per_voxel() const { return get<std::int16_t>(72); }
  /// Along axis n = 1...
  [[nodiscard]] float spacing(std::size_t n) const { return get<float>(76 + 4 * n); }
  [[nodiscard]] float voxel_offset() const { return get<float>(108); }
  [[nodiscard]] float slope() const { return get<float>(112); }
  [[nodiscard]] float intercept() const { return get<float>(116); }
  /// Whether lengths are in mm, or nothing says what they are in.
  [[nodiscard]] bool in_mm() const;
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
  [[nodiscard]] T get(std::size_t offset) const;

  std::array<char, kBytes> bytes_;
  bool swapped_ = false;
  bool valid_ = true;
};

struct NiftiFile {
  NiftiHeader header;
  bool compressed = false;  ///< by gzip
};

/// Reads the header, decompressed where the file is a gzip file. Nothing when there are fewer than 348 bytes.
[[nodiscard]] std::optional<NiftiFile> read_nifti_header(const std::filesystem::path& path);

}  // namespace splatlas

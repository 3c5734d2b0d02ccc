// Header of NIfTI-1, NIfTI-2 and Analyze 7.5 files.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <optional>
#include <span>

#include "format/content/grid.h"
#include "format/result.h"
#include "preprocess/import/notes.h"

namespace splatlas {

/// NIfTI's number of each VoxelType.
inline constexpr std::array<std::int16_t, 9> kNiftiTypes{0, 2, 256, 512, 4, 768, 8, 16, 64};

/// Numbers at byte offsets, in this machine's byte order or, if `is_swapped`, in the other.
class Fields {
 public:
  Fields(std::span<const std::byte> bytes, bool is_swapped) : bytes_(bytes), is_swapped_(is_swapped) {}

  template <typename T>
  [[nodiscard]] T get(std::size_t offset) const {
    std::array<std::byte, sizeof(T)> field{};
    std::ranges::copy(bytes_.subspan(offset, sizeof(T)), field.begin());
    if (is_swapped_) std::ranges::reverse(field);
    T value;
    std::memcpy(&value, field.data(), sizeof(T));
    return value;
  }
  /// `numbers.size()` numbers of type T, one after another.
  template <typename T, typename Numbers>
  void get_all(std::size_t offset, Numbers& numbers) const {
    for (std::size_t n = 0; n < numbers.size(); ++n) {
      numbers[n] = static_cast<typename Numbers::value_type>(get<T>(offset + n * sizeof(T)));
    }
  }

 private:
  std::span<const std::byte> bytes_;
  bool is_swapped_;
};

/// The fields of a header that describe its voxels and their geometry (nifti1.h, nifti2.h).
struct NiftiHeader {
  enum class Kind : std::uint8_t { kNifti1, kNifti2, kAnalyze };

  Kind kind = Kind::kNifti1;
  bool is_swapped = false;            ///< the file's byte order differs from this machine's
  bool is_pair = false;               ///< voxels are in a second file, .img
  std::array<std::int64_t, 8> dim{};  ///< number of axes, then voxels along axis 1...
  std::int64_t datatype = 0, bits_per_voxel = 0;
  std::array<double, 8> pixdim{};  ///< qfac, then spacing along axis 1...
  double voxel_offset = 0, slope = 0, intercept = 0;
  std::int64_t qform_code = 0, sform_code = 0;
  std::array<double, 3> quaternion{}, qform_offset{};  ///< b, c, d
  std::array<double, 12> sform{};                      ///< rows of the affine from indices to RAS
  std::int64_t units = 0, intent = 0;

  /// Length of the longest header, and of the header of a kind.
  static constexpr std::size_t kMaxBytes = 540, kNifti1Bytes = 348;
  [[nodiscard]] std::size_t bytes() const { return kind == Kind::kNifti2 ? kMaxBytes : kNifti1Bytes; }
  /// Factor from the unit of length to mm; nullopt if it is unknown.
  [[nodiscard]] std::optional<double> mm_per_unit() const;
};

/// Parses the first bytes of a file, at most kMaxBytes. kFailed for other files, for numbers of axes beyond
/// 7, and for CIFTI-2, which holds no volume. Analyze has no magic: a header of its length and valid axes.
[[nodiscard]] Result<NiftiHeader> parse_nifti_header(std::span<const std::byte> bytes,
                                                     const std::filesystem::path& path);

/// The grid of a header, in LPS mm. As nibabel and the standard say: the sform if its code is above 0, else
/// the qform, else no orientation (x to the left, centred: LAS). A sheared sform gives a sheared grid. A
/// warning tells if sform and qform place voxels differently, and if there is no orientation. kFailed for
/// geometry that cannot be.
[[nodiscard]] Result<Grid> nifti_grid(const NiftiHeader& header, const std::filesystem::path& path,
                                      Notes& notes);

/// The grid of an affine from indices to RAS mm, row by row. Columns that are orthogonal within the rounding
/// of floats become exactly so. Not validated.
[[nodiscard]] Grid grid_of_ras_affine(const Index3& size, const std::array<double, 12>& affine);

}  // namespace splatlas

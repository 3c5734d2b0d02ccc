#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <memory>

#include <fmt/format.h>
#include <zlib.h>

#include "format/ascii_text.h"
#include "preprocess/import/check_image_file.h"
#include "preprocess/import/image_payload.h"
#include "preprocess/import/text_file.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

/// Numbers of a NIfTI-1 header (nifti1.h, offsets in bytes), in the byte order of the file.
class NiftiHeader {
 public:
  static constexpr std::size_t kBytes = 348;

  explicit NiftiHeader(const std::array<char, kBytes>& bytes) : bytes_(bytes) {
    swapped_ = raw<std::int32_t>(0) != kMagicSize;
    if (swapped_ && get<std::int32_t>(0) != kMagicSize) valid_ = false;
    if (std::memcmp(&bytes_[344], "n+1", 4) != 0) valid_ = false;
  }

  [[nodiscard]] bool valid() const { return valid_; }
  [[nodiscard]] std::int16_t dim(std::size_t n) const { return get<std::int16_t>(40 + 2 * n); }
  [[nodiscard]] std::int16_t datatype() const { return get<std::int16_t>(70); }
  [[nodiscard]] std::int16_t bits_per_voxel() const { return get<std::int16_t>(72); }
  [[nodiscard]] float spacing(std::size_t n) const { return get<float>(76 + 4 * n); }
  [[nodiscard]] float voxel_offset() const { return get<float>(108); }
  [[nodiscard]] float slope() const { return get<float>(112); }
  [[nodiscard]] float intercept() const { return get<float>(116); }
  /// qform, then sform.
  [[nodiscard]] float orientation(std::size_t n) const { return get<float>(256 + 4 * n); }
  static constexpr std::size_t kOrientationNumbers = 18;

 private:
  static constexpr std::int32_t kMagicSize = 348;

  template <typename T>
  [[nodiscard]] T raw(std::size_t offset) const {
    T value;
    std::memcpy(&value, &bytes_[offset], sizeof(T));
    return value;
  }
  template <typename T>
  [[nodiscard]] T get(std::size_t offset) const {
    std::array<char, sizeof(T)> field;
    std::memcpy(field.data(), &bytes_[offset], sizeof(T));
    if (swapped_) std::reverse(field.begin(), field.end());
    T value;
    std::memcpy(&value, field.data(), sizeof(T));
    return value;
  }

  const std::array<char, kBytes>& bytes_;
  bool swapped_ = false;
  bool valid_ = true;
};

/// Bytes of a voxel of a NIfTI datatype that atlases take; 0 for others.
int bytes_of_datatype(std::int16_t datatype) {
  switch (datatype) {
    case 2:              // uint8
    case 256: return 1;  // int8
    case 4:              // int16
    case 512: return 2;  // uint16
    case 8:              // int32
    case 16:             // float32
    case 768: return 4;  // uint32
    case 64: return 8;   // float64
    default: return 0;
  }
}

struct GzClose {
  void operator()(gzFile_s* file) const { gzclose(file); }
};

/// The first 348 bytes, decompressed where the file is a gzip file. False when there are fewer.
bool read_header(const fs::path& path, std::array<char, NiftiHeader::kBytes>& bytes, bool& compressed) {
  const std::unique_ptr<gzFile_s, GzClose> file(gzopen(path.c_str(), "rb"));
  if (!file) return false;
  compressed = gzdirect(file.get()) == 0;
  return gzread(file.get(), bytes.data(), static_cast<unsigned>(bytes.size())) ==
         static_cast<int>(bytes.size());
}

Result<void> check_geometry(const NiftiHeader& header, const fs::path& path) {
  const std::size_t axes = std::min<std::size_t>(3, static_cast<std::size_t>(header.dim(0)));
  for (std::size_t n = 1; n <= axes; ++n) {
    if (const float spacing = header.spacing(n); !(is_plausible(spacing) && spacing > 0)) {
      return fail(ErrorCode::kFailed,
                  fmt::format("{}: has a spacing of {} mm along axis {}; it must be positive", path.string(),
                              spacing, n));
    }
  }
  for (std::size_t n = 0; n < NiftiHeader::kOrientationNumbers; ++n) {
    if (!is_plausible(header.orientation(n))) {
      return fail(ErrorCode::kFailed,
                  fmt::format("{}: has {} in its orientation (qform or sform), which cannot be",
                              path.string(), header.orientation(n)));
    }
  }
  if (!std::isfinite(header.slope()) || !std::isfinite(header.intercept())) {
    return fail(
        ErrorCode::kFailed,
        fmt::format("{}: has a value scale (scl_slope, scl_inter) that is not a number", path.string()));
  }
  return {};
}

Result<std::uint64_t> expected_bytes(const NiftiHeader& header, const fs::path& path) {
  const int dimensions = header.dim(0);
  if (dimensions < 2 || dimensions > 7) {
    return fail(ErrorCode::kFailed,
                fmt::format("{}: has {} dimensions; a volume has 2 or 3", path.string(), dimensions));
  }
  std::array<std::int64_t, 7> sizes{};
  for (int n = 0; n < dimensions; ++n)
    sizes[static_cast<std::size_t>(n)] = header.dim(static_cast<std::size_t>(n) + 1);
  for (int n = 3; n < dimensions; ++n) {
    if (sizes[static_cast<std::size_t>(n)] != 1) {
      return fail(ErrorCode::kFailed, fmt::format("{}: holds {} volumes; give one volume a file",
                                                  path.string(), sizes[static_cast<std::size_t>(n)]));
    }
  }
  const int bytes = bytes_of_datatype(header.datatype());
  if (bytes == 0) {
    return fail(
        ErrorCode::kFailed,
        fmt::format("{}: has pixels of NIfTI type {}; 8, 16 and 32-bit integers, float and double are read",
                    path.string(), header.datatype()));
  }
  if (header.bits_per_voxel() != 8 * bytes) {
    return fail(ErrorCode::kFailed,
                fmt::format("{}: contradicts itself: {} bits a voxel, but its type has {}", path.string(),
                            header.bits_per_voxel(), 8 * bytes));
  }
  return payload_bytes(path, std::span(sizes).first(static_cast<std::size_t>(dimensions)),
                       static_cast<std::uint64_t>(bytes));
}

}  // namespace

Result<void> check_nifti_file(const fs::path& path) {
  std::array<char, NiftiHeader::kBytes> bytes{};
  bool compressed = false;
  if (!read_header(path, bytes, compressed)) {
    return fail(ErrorCode::kFailed,
                fmt::format("{}: is not a NIfTI file (too short, or a damaged gzip file)", path.string()));
  }
  const NiftiHeader header(bytes);
  if (!header.valid()) {
    return fail(ErrorCode::kFailed, fmt::format("{}: is not a single-file NIfTI-1 file", path.string()));
  }
  if (compressed != to_lower(path.filename().string()).ends_with(".gz")) {
    return fail(ErrorCode::kFailed, fmt::format("{}: is {}compressed, which its ending denies; rename it",
                                                path.string(), compressed ? "" : "not "));
  }
  SPLATLAS_RETURN_IF_ERROR(check_geometry(header, path));
  SPLATLAS_ASSIGN_OR_RETURN(const std::uint64_t expected, expected_bytes(header, path));
  const float offset = header.voxel_offset();
  constexpr float kMaxOffset = 1 << 24;  // beyond, a float skips integers
  if (!(offset >= NiftiHeader::kBytes && offset <= kMaxOffset)) {
    return fail(ErrorCode::kFailed,
                fmt::format("{}: puts its pixels at byte {}, which cannot be", path.string(), offset));
  }
  const auto start = static_cast<std::uint64_t>(offset);
  return compressed ? check_deflated_payload(path, 0, start + expected)
                    : check_raw_payload(path, start, expected);
}

}  // namespace splatlas

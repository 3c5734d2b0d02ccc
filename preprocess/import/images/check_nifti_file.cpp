#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "format/system/ascii_text.h"
#include "format/system/result_macros.h"
#include "preprocess/import/images/check_image_file.h"
#include "preprocess/import/images/image_payload.h"
#include "preprocess/import/images/nifti_header.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

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
  const VoxelType type = header.voxel_type();
  if (type == VoxelType::kNone) {
    return fail(
        ErrorCode::kFailed,
        fmt::format("{}: has pixels of NIfTI type {}; 8, 16 and 32-bit integers, float and double are read",
                    path.string(), header.datatype()));
  }
  const std::size_t bytes = bytes_of(type);
  if (header.bits_per_voxel() != static_cast<int>(8 * bytes)) {
    return fail(ErrorCode::kFailed,
                fmt::format("{}: contradicts itself: {} bits a voxel, but its type has {}", path.string(),
                            header.bits_per_voxel(), 8 * bytes));
  }
  return payload_bytes(path, std::span(sizes).first(static_cast<std::size_t>(dimensions)), bytes);
}

}  // namespace

Result<void> check_nifti_file(const fs::path& path) {
  const std::optional<NiftiFile> file = read_nifti_header(path);
  if (!file) {
    return fail(ErrorCode::kFailed,
                fmt::format("{}: is not a NIfTI file (too short, or a damaged gzip file)", path.string()));
  }
  const auto& [header, compressed] = *file;
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
  return compressed ? check_deflated_payload(path, 0, expected, start)
                    : check_raw_payload(path, start, expected);
}

}  // namespace splatlas

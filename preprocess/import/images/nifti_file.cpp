#include "preprocess/import/images/nifti_file.h"

#include <cmath>
#include <span>
#include <utility>

#include "format/system/ascii_text.h"
#include "format/system/result_macros.h"
#include "preprocess/import/images/check_image_file.h"
#include "preprocess/import/images/read_deflated.h"
#include "preprocess/import/import_error.h"

namespace splatlas {
namespace {

/// Number of bytes read; fewer than requested at the end of the stream or before damage.
std::size_t read_some(gzFile_s& stream, std::span<std::byte> bytes) {
  constexpr std::size_t kMaxRead = std::size_t{1} << 30;  // zlib's counts are of type int
  std::size_t done = 0;
  while (done < bytes.size()) {
    const auto wanted = static_cast<unsigned>(std::min(bytes.size() - done, kMaxRead));
    const int count = gzread(&stream, &bytes[done], wanted);
    if (count <= 0) break;
    done += static_cast<std::size_t>(count);
  }
  return done;
}

template <typename Scaled>
VoxelBuffer scaled(const VoxelBuffer& voxels, VoxelType type, double slope, double intercept) {
  const std::size_t count = voxels.bytes.size() / bytes_of(voxels.type);
  VoxelBuffer result{type, std::vector<std::byte>(count * sizeof(Scaled))};
  visit_voxel_type(voxels.type, [&]<typename T>(T) {
    for (std::size_t v = 0; v < count; ++v)
      result.as<Scaled>()[v] =
          static_cast<Scaled>(static_cast<double>(voxels.as<T>()[v]) * slope + intercept);
  });
  return result;
}

}  // namespace

VoxelType NiftiHeader::voxel_type() const {
  switch (datatype()) {
    case 2: return VoxelType::kUInt8;
    case 256: return VoxelType::kInt8;
    case 4: return VoxelType::kInt16;
    case 512: return VoxelType::kUInt16;
    case 8: return VoxelType::kInt32;
    case 768: return VoxelType::kUInt32;
    case 16: return VoxelType::kFloat32;
    case 64: return VoxelType::kFloat64;
    default: return VoxelType::kNone;
  }
}

Result<NiftiFile> NiftiFile::open(const std::filesystem::path& path) {
  Stream stream(gzopen(path.c_str(), "rb"));
  std::array<char, NiftiHeader::kBytes> bytes{};
  if (!stream || read_some(*stream, std::as_writable_bytes(std::span(bytes))) != bytes.size())
    return bad_file(path, "is not a NIfTI file (too short, or a damaged gzip file)");
  NiftiFile file(path, NiftiHeader(bytes), std::move(stream));
  if (!file.header_.valid()) return bad_file(path, "is not a single-file NIfTI-1 file");
  if (file.is_compressed() != to_lower(path.filename().string()).ends_with(".gz")) {
    return bad_file(path, "is {}compressed, which its ending denies; rename it",
                    file.is_compressed() ? "" : "not ");
  }
  SPLATLAS_RETURN_IF_ERROR(file.check_geometry());
  SPLATLAS_RETURN_IF_ERROR(file.check_voxels());
  return file;
}

Result<void> NiftiFile::check_geometry() const {
  for (int n = 1; n <= std::min<int>(3, header_.dim(0)); ++n) {
    const float spacing = header_.spacing(static_cast<std::size_t>(n));
    if (!(is_plausible(spacing) && spacing > 0))
      return bad_file(path_, "has a spacing of {} mm along axis {}; it must be positive", spacing, n);
  }
  for (std::size_t n = 0; n < NiftiHeader::kOrientationNumbers; ++n) {
    if (const float number = header_.orientation(n); !is_plausible(number))
      return bad_file(path_, "has {} in its orientation (qform or sform), which cannot be", number);
  }
  if (!std::isfinite(header_.slope()) || !std::isfinite(header_.intercept()))
    return bad_file(path_, "has a value scale (scl_slope, scl_inter) that is not a number");
  constexpr float kMaxOffset = 1 << 24;  // beyond, a float skips integers
  if (const float offset = header_.voxel_offset(); !(offset >= NiftiHeader::kBytes && offset <= kMaxOffset))
    return bad_file(path_, "puts its pixels at byte {}, which cannot be", offset);
  return {};
}

Result<void> NiftiFile::check_voxels() {
  const int dimensions = header_.dim(0);
  if (dimensions < 2 || dimensions > 7)
    return bad_file(path_, "has {} dimensions; a volume has 2 or 3", dimensions);
  std::vector<std::int64_t> sizes;
  for (std::size_t n = 1; n <= static_cast<std::size_t>(dimensions); ++n) {
    sizes.push_back(header_.dim(n));
    if (n > 3) SPLATLAS_RETURN_IF_ERROR(check_one_volume(path_, sizes.back()));
  }
  const VoxelType type = header_.voxel_type();
  if (type == VoxelType::kNone)
    return bad_pixel_type(path_, fmt::format("NIfTI type {}", header_.datatype()));
  if (const auto bits = static_cast<int>(8 * bytes_of(type)); header_.bits_per_voxel() != bits) {
    return bad_file(path_, "contradicts itself: {} bits a voxel, but its type has {}",
                    header_.bits_per_voxel(), bits);
  }
  SPLATLAS_ASSIGN_OR_RETURN(voxel_bytes_, payload_bytes(path_, sizes, bytes_of(type)));
  const auto offset = static_cast<std::uint64_t>(header_.voxel_offset());
  if (!is_compressed()) return check_raw_payload(path_, offset, voxel_bytes_, voxel_bytes_);
  return check_raw_payload(path_, 0, (offset + voxel_bytes_) / kMaxDeflateRatio, voxel_bytes_);
}

Result<VoxelBuffer> NiftiFile::read_voxels() {
  VoxelBuffer voxels{header_.voxel_type(), {}};
  SPLATLAS_RETURN_IF_ERROR(fill(voxels));
  SPLATLAS_RETURN_IF_ERROR(check_end());
  if (header_.swapped()) swap_bytes(voxels);
  // A slope of 0 stands for unscaled values.
  const double slope = header_.slope(), intercept = header_.intercept();
  const bool is_identity = !(slope < 1 || slope > 1) && !(intercept < 0 || intercept > 0);
  if (is_identity || !(slope < 0 || slope > 0)) return voxels;
  return voxels.type == VoxelType::kFloat64 ? scaled<double>(voxels, VoxelType::kFloat64, slope, intercept)
                                            : scaled<float>(voxels, VoxelType::kFloat32, slope, intercept);
}

Result<void> NiftiFile::fill(VoxelBuffer& voxels) {
  voxels.bytes.resize(voxel_bytes_);
  const auto start = static_cast<z_off_t>(header_.voxel_offset());
  const std::size_t read =
      gzseek(stream_.get(), start, SEEK_SET) == start ? read_some(*stream_, voxels.bytes) : 0;
  if (read == voxel_bytes_) return {};
  int status = Z_OK;
  const char* const reason = gzerror(stream_.get(), &status);
  if (status == Z_OK || status == Z_BUF_ERROR) return truncated_file(path_, voxel_bytes_, read);
  return bad_file(path_, "its pixels are damaged after {} bytes ({})", read, reason);
}

Result<void> NiftiFile::check_end() {
  if (!is_compressed()) return {};
  std::vector<std::byte> surplus(1 << 18);
  for (std::uint64_t found = 0; found < kMaxSurplus; found += surplus.size()) {
    if (read_some(*stream_, surplus) < surplus.size()) break;
  }
  int status = Z_OK;
  const char* const reason = gzerror(stream_.get(), &status);
  if (status == Z_OK) return {};
  return bad_file(path_, "is truncated or damaged at the end of its compressed pixels ({})", reason);
}

}  // namespace splatlas

#include "preprocess/import/images/nifti_header.h"

#include <algorithm>

#include "preprocess/import/images/gzip_file.h"

namespace splatlas {

template <typename T>
T NiftiHeader::get(std::size_t offset) const {
  std::array<char, sizeof(T)> field;
  std::memcpy(field.data(), &bytes_[offset], sizeof(T));
  if (swapped_) std::reverse(field.begin(), field.end());
  T value;
  std::memcpy(&value, field.data(), sizeof(T));
  return value;
}

template std::int16_t NiftiHeader::get(std::size_t) const;
template float NiftiHeader::get(std::size_t) const;

NiftiHeader::NiftiHeader(const std::array<char, kBytes>& bytes) : bytes_(bytes) {
  constexpr auto kOwnSize = static_cast<std::int32_t>(kBytes);
  swapped_ = get<std::int32_t>(0) != kOwnSize;
  valid_ = get<std::int32_t>(0) == kOwnSize && std::memcmp(&bytes_[344], "n+1", 4) == 0;
}

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

bool NiftiHeader::in_mm() const {
  constexpr int kUnknown = 0, kMillimetres = 2, kSpaceBits = 7;
  const int unit = bytes_[123] & kSpaceBits;
  return unit == kUnknown || unit == kMillimetres;
}

std::optional<NiftiFile> read_nifti_header(const std::filesystem::path& path) {
  const GzipFile file = open_gzip_file(path);
  if (!file) return std::nullopt;
  const bool compressed = gzdirect(file.get()) == 0;
  std::array<char, NiftiHeader::kBytes> bytes;
  if (!read_all(*file, std::as_writable_bytes(std::span(bytes)))) return std::nullopt;
  return NiftiFile{NiftiHeader(bytes), compressed};
}

}  // namespace splatlas

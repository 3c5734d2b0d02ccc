#include "preprocess/import/images/pixels/narrow_integers.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <utility>

#include "preprocess/import/import_error.h"

namespace splatlas {
namespace {

template <typename Narrow, typename Wide>
VoxelBuffer copied(std::span<const Wide> values, VoxelType type) {
  VoxelBuffer result{type, std::vector<std::byte>(values.size() * sizeof(Narrow))};
  std::ranges::transform(values, result.as<Narrow>(), [](Wide value) { return static_cast<Narrow>(value); });
  return result;
}

template <typename Wide>
Result<VoxelBuffer> narrowed(std::span<const std::byte> bytes, const std::filesystem::path& path) {
  const std::span values(reinterpret_cast<const Wide*>(bytes.data()), bytes.size() / sizeof(Wide));
  const auto [low, high] = std::ranges::minmax(values);
  if (std::in_range<std::int32_t>(low) && std::in_range<std::int32_t>(high))
    return copied<std::int32_t>(values, VoxelType::kInt32);
  if (std::in_range<std::uint32_t>(low) && std::in_range<std::uint32_t>(high))
    return copied<std::uint32_t>(values, VoxelType::kUInt32);
  const Wide beyond = std::in_range<std::int32_t>(low) && low < 0 ? high
                      : std::in_range<std::uint32_t>(low)         ? high
                                                                  : low;
  return bad_file(path, "holds 64-bit integers from {} to {}; {} does not fit 32 bits", low, high, beyond);
}

}  // namespace

Result<VoxelBuffer> narrow_integers(std::span<const std::byte> bytes, WideInteger type,
                                    const std::filesystem::path& path) {
  return type == WideInteger::kSigned ? narrowed<std::int64_t>(bytes, path)
                                      : narrowed<std::uint64_t>(bytes, path);
}

}  // namespace splatlas

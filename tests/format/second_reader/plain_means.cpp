#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>

#include "tests/format/second_reader/flat_directory.h"
#include "tests/format/second_reader/plain_codecs.h"

namespace splatlas::second {
namespace {

using Bytes = std::vector<std::byte>;

/// The mean of values of a type, as bytes.
template <typename T>
Bytes mean_of(const Bytes& values, const std::vector<std::size_t>& voxels) {
  double sum = 0;
  for (const std::size_t v : voxels) sum += static_cast<double>(number_at<T>(values, v * sizeof(T)));
  const double mean = sum / static_cast<double>(voxels.size());
  T rounded = std::is_integral_v<T> ? static_cast<T>(std::floor(mean + 0.5)) : static_cast<T>(mean);
  if (std::isnan(mean)) rounded = std::numeric_limits<T>::quiet_NaN();
  Bytes bytes(sizeof(T));
  std::memcpy(bytes.data(), &rounded, sizeof(T));
  return bytes;
}

}  // namespace

Blocks blocks_of(const std::vector<std::size_t>& voxels, const std::array<std::int64_t, 3>& size,
                 std::uint8_t type) {
  Blocks blocks;
  for (std::size_t a = 0; a < 3; ++a) blocks.size[a] = (size[a] + 3) / 4;
  std::array<std::int64_t, 2> first = {size[0], size[1]}, last{-1, -1};
  for (const std::size_t v : voxels) {
    const auto voxel = static_cast<std::int64_t>(v);
    const std::array<std::int64_t, 3> at{voxel % size[0] / 4, voxel / size[0] % size[1] / 4,
                                         voxel / size[0] / size[1] / 4};
    const std::int64_t place = (at[2] * blocks.size[1] + at[1]) * blocks.size[0] + at[0];
    blocks.voxels[static_cast<std::size_t>(place)].push_back(v);
    for (std::size_t a = 0; a < 2; ++a) {
      first[a] = std::min(first[a], at[a]);
      last[a] = std::max(last[a], at[a]);
    }
  }
  blocks.predicted = is_predicted(type, blocks.voxels.size(), last[0] - first[0] + 1, last[1] - first[1] + 1);
  return blocks;
}

bool has_means(const Blocks& blocks, const Bytes& stream, const Bytes& values, std::uint8_t type) {
  constexpr std::array kMeans{mean_of<std::uint8_t>, mean_of<std::int8_t>,   mean_of<std::uint16_t>,
                              mean_of<std::int16_t>, mean_of<std::uint32_t>, mean_of<std::int32_t>,
                              mean_of<float>,        mean_of<double>};
  std::vector<std::size_t> places;
  Bytes expected;
  for (const auto& [block, voxels] : blocks.voxels) {
    places.push_back(block);
    const Bytes mean = kMeans.at(type - std::size_t{1})(values, voxels);
    expected.insert(expected.end(), mean.begin(), mean.end());
  }
  return (blocks.predicted ? decode_predicted(stream, places, blocks.size, type) : stream) == expected;
}

}  // namespace splatlas::second

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <map>

#include "tests/format/second_reader/flat_directory.h"
#include "tests/format/second_reader/plain_codecs.h"

namespace splatlas::second {
namespace {

using Offset = std::array<std::int64_t, 3>;

constexpr std::array<Offset, 14> kNeighbours{{{0, -1, 0},
                                              {0, 0, -1},
                                              {1, -1, 0},
                                              {-1, -1, 0},
                                              {-1, 0, -1},
                                              {0, -1, -1},
                                              {1, 0, -1},
                                              {0, 1, -1},
                                              {1, -1, -1},
                                              {-1, -1, -1},
                                              {-1, 1, -1},
                                              {1, 1, -1},
                                              {0, -2, 0},
                                              {0, 0, -2}}};

struct Known {
  std::int64_t value = 0, error = 0;
};

/// Prediction of a voxel from its predecessors.
class Neighbourhood {
 public:
  explicit Neighbourhood(const std::array<std::int64_t, 3>& size) : size_(size) {}

  void add(std::size_t voxel, const Known& known) { known_[voxel] = known; }
  /// Null if the group has no such voxel.
  [[nodiscard]] const Known* at(std::size_t voxel, const Offset& step) const {
    const auto v = static_cast<std::int64_t>(voxel);
    const std::int64_t i = v % size_[0] + step[0], j = v / size_[0] % size_[1] + step[1],
                       k = v / (size_[0] * size_[1]) + step[2];
    if (i < 0 || j < 0 || k < 0 || i >= size_[0] || j >= size_[1] || k >= size_[2]) return nullptr;
    const auto found = known_.find(static_cast<std::size_t>((k * size_[1] + j) * size_[0] + i));
    return found == known_.end() ? nullptr : &found->second;
  }

 private:
  std::array<std::int64_t, 3> size_;
  std::map<std::size_t, Known> known_;
};

std::size_t bucket_of(std::int64_t d) {
  if (d == 0) return 0;
  const auto log = static_cast<std::int64_t>(std::bit_width(static_cast<std::uint64_t>(d))) - 1;
  const std::int64_t h = log == 0 ? 0 : (d >> (log - 1)) & 1;
  return static_cast<std::size_t>(std::min<std::int64_t>(15, 2 * log + h + 1));
}

std::int64_t floor_of_64ths(std::int64_t sum) {
  return sum >= 0 ? sum / 64 : -((63 - sum) / 64);
}

}  // namespace

bool is_predicted(std::uint8_t type, std::uint64_t voxels, std::int64_t width, std::int64_t height) {
  return type >= 1 && type <= 4 && voxels >= 1 && voxels < (std::uint64_t{1} << 32) &&
         (width + 2) * (height + 3) <= 1 << 24;
}

std::vector<std::byte> decode_predicted(const std::vector<std::byte>& stream,
                                        const std::vector<std::size_t>& voxels,
                                        const std::array<std::int64_t, 3>& size, std::uint8_t type) {
  const std::size_t bytes = type <= 2 ? 1 : 2;
  const std::int64_t levels = bytes == 1 ? 256 : 65536;
  const std::int64_t of_signed = type == 2 || type == 4 ? levels / 2 : 0;
  std::array<std::size_t, 16> next{};  // next residual of each bucket
  for (std::size_t b = 0; b + 1 < 16; ++b) next[b + 1] = next[b] + number_at<std::uint32_t>(stream, 4 * b);
  std::array<std::int64_t, 14> weights{};
  for (std::size_t n = 0; n < 14; ++n) weights[n] = number_at<std::int8_t>(stream, 64 + n);
  const auto error_shift = number_at<std::uint8_t>(stream, 78);

  Neighbourhood neighbourhood(size);
  std::vector<std::byte> values;
  std::int64_t latest = 0;
  for (const std::size_t voxel : voxels) {
    const Known* before = neighbourhood.at(voxel, {-1, 0, 0});
    const Known* first = nullptr;
    std::int64_t sum = 32, rest = 64, d = 0;
    for (std::size_t n = 0; n < 14; ++n) {
      const Known* neighbour = neighbourhood.at(voxel, kNeighbours[n]);
      if (n < 8) d += neighbour != nullptr ? neighbour->error : 4;
      if (neighbour == nullptr) continue;
      if (first == nullptr) first = neighbour;
      sum += weights[n] * neighbour->value;
      rest -= weights[n];
    }
    const std::int64_t b = before != nullptr ? before->value : first != nullptr ? first->value : latest;
    const std::int64_t prediction = floor_of_64ths(sum + rest * b);

    const std::size_t place = next[bucket_of(d)]++;
    std::int64_t residual = number_at<std::uint8_t>(stream, kModelBytes + place);
    if (bytes == 2)
      residual += std::int64_t{number_at<std::uint8_t>(stream, kModelBytes + voxels.size() + place)} * 256;
    const std::int64_t difference = residual % 2 == 0 ? residual / 2 : -(residual + 1) / 2;
    latest = ((prediction + difference) % levels + levels) % levels;
    neighbourhood.add(voxel, {latest, std::min<std::int64_t>(255, std::abs(difference) >> error_shift)});
    const std::int64_t stored = latest - of_signed;
    for (std::size_t n = 0; n < bytes; ++n) values.push_back(static_cast<std::byte>(stored >> (8 * n)));
  }
  return values;
}

}  // namespace splatlas::second

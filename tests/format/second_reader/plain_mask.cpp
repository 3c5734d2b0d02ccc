#include <algorithm>
#include <cmath>

#include "tests/format/second_reader/plain_codecs.h"

namespace splatlas::second {
namespace {

using Triple = std::array<std::int64_t, 3>;

constexpr std::array<Triple, 12> kOffsets{{{-1, 0, 0},
                                           {-2, 0, 0},
                                           {0, -1, 0},
                                           {-1, -1, 0},
                                           {1, -1, 0},
                                           {0, -2, 0},
                                           {0, 0, -1},
                                           {-1, 0, -1},
                                           {1, 0, -1},
                                           {0, -1, -1},
                                           {0, 1, -1},
                                           {0, 0, -2}}};
constexpr std::array<int, 12> kVotes{9, -1, 7, -1, 4, -1, 5, -2, 3, -2, 5, -3};

struct Pair {
  std::int64_t p = 0, n = 4;
};

std::vector<Pair> first_pairs() {
  std::vector<Pair> pairs(4096);
  for (std::size_t number = 0; number < pairs.size(); ++number) {
    int v = 0;
    for (std::size_t bit = 0; bit < 12; ++bit) v += (number >> bit) % 2 == 1 ? kVotes[bit] : -kVotes[bit];
    pairs[number].p = std::clamp<std::int64_t>(std::lround(65536 / (1 + std::exp(-v / 4.0))), 64, 65472);
  }
  return pairs;
}

class Bits {
 public:
  explicit Bits(const std::vector<std::byte>& stream) : stream_(stream) {
    for (int n = 0; n < 4; ++n) z_ = 256 * z_ + next();
  }

  bool decode(Pair& pair) {
    const std::uint64_t t = r_ / 65536 * static_cast<std::uint64_t>(pair.p);
    const bool set = z_ < t;
    r_ = set ? t : r_ - t;
    z_ = set ? z_ : z_ - t;
    for (; r_ < (1 << 24); r_ *= 256) z_ = 256 * z_ + next();
    const double moved = static_cast<double>(((set ? 65535 : 0) - pair.p) * 2 * (32768 / (pair.n + 1)));
    pair.p =
        std::clamp<std::int64_t>(pair.p + static_cast<std::int64_t>(std::floor(moved / 65536)), 16, 65520);
    pair.n = std::min<std::int64_t>(pair.n + 1, 255);
    return set;
  }

 private:
  std::uint64_t next() { return at_ < stream_.size() ? std::to_integer<std::uint64_t>(stream_[at_++]) : 0; }

  const std::vector<std::byte>& stream_;
  std::size_t at_ = 1;  // after the marker
  std::uint64_t r_ = 0xffffffff, z_ = 0;
};

}  // namespace

std::vector<bool> decode_mask(const std::vector<std::byte>& stream, const Triple& first, const Triple& last,
                              const Triple& size, std::size_t axis) {
  // Grid axes along scanlines, rows and slices.
  const std::array<std::size_t, 3> order = axis == 0   ? std::array<std::size_t, 3>{1, 2, 0}
                                           : axis == 1 ? std::array<std::size_t, 3>{0, 2, 1}
                                                       : std::array<std::size_t, 3>{0, 1, 2};
  std::vector<bool> voxels(static_cast<std::size_t>(size[0] * size[1] * size[2]));
  std::vector<Pair> pairs = first_pairs();
  Bits bits(stream);
  const auto place = [&](const Triple& v) {
    return static_cast<std::size_t>((v[2] * size[1] + v[1]) * size[0] + v[0]);
  };
  const auto is_set = [&](const Triple& v) {
    for (std::size_t a = 0; a < 3; ++a) {
      if (v[a] < first[a] || v[a] > last[a]) return false;
    }
    return static_cast<bool>(voxels[place(v)]);
  };
  Triple v{};
  for (v[order[2]] = first[order[2]]; v[order[2]] <= last[order[2]]; ++v[order[2]]) {
    for (v[order[1]] = first[order[1]]; v[order[1]] <= last[order[1]]; ++v[order[1]]) {
      for (v[order[0]] = first[order[0]]; v[order[0]] <= last[order[0]]; ++v[order[0]]) {
        std::size_t number = 0;
        for (std::size_t bit = 0; bit < kOffsets.size(); ++bit) {
          Triple other = v;
          for (std::size_t a = 0; a < 3; ++a) other[order[a]] += kOffsets[bit][a];
          number += static_cast<std::size_t>(is_set(other)) << bit;
        }
        if (bits.decode(pairs[number])) voxels[place(v)] = true;
      }
    }
  }
  return voxels;
}

}  // namespace splatlas::second

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdlib>
#include <utility>

#include "format/derive/surface_net.h"
#include "format/tasks/free_memory.h"
#include "format/tasks/task_control.h"

namespace splatlas {
namespace {

using Vec4i = std::array<std::int32_t, 4>;

constexpr std::int32_t kOne = 1 << 20;           // length of an area vector at the start
constexpr std::int32_t kStepsOfMean = 4;         // steps between divisions
constexpr std::int32_t kMeans = 4, kMean = 625;  // 5 to the power of kStepsOfMean
constexpr std::int32_t kMinLength = 5 << 16;     // sum of components that replaces a direction
constexpr int kRelaxations = 8;
constexpr std::array<std::int32_t, kRelaxations> kOmega{4096, 7464, 6956, 6640, 6458, 6358, 6304, 2731};
constexpr std::int32_t kMaxStep = 8192, kMaxOffset = 1792;  // 2 and 7/16 voxel, in 1/4096 voxel

/// Quotient by a power of two, rounded towards zero.
template <int kBits, typename Integer>
constexpr Integer shifted(Integer x) {
  constexpr int kSignBit = 8 * sizeof(Integer) - 1;
  return (x + (x >> kSignBit & ((Integer{1} << kBits) - 1))) >> kBits;
}

/// The target of a vertex, times 2048: constant + sum of weights * offsets of its neighbours.
struct Pull {
  std::int32_t constant = 0;
  std::array<std::int16_t, 4> weights{};
};

/// Arrays of one vertex each. Threads keep them for their next surface: new pages cost as much as the work.
struct Scratch {
  std::vector<std::int64_t> lanes, next_lanes;
  std::vector<Vec4i> sums, next_sums;
  std::vector<Pull> pulls;
  std::vector<std::int16_t> before, now, next;

  /// Of the calling thread, for `vertices` vertices.
  static Scratch& of_thread(std::size_t vertices) {
    static thread_local Scratch scratch;
    scratch.visit([&](auto& array) {
      if (array.size() < vertices) array.resize(vertices);
    });
    return scratch;
  }
  void shrink() {
    visit([](auto& array) {
      if (array.size() > kMaxKeptVertices) free_memory(array);
    });
  }

 private:
  template <typename Visit>
  void visit(const Visit& one) {
    one(lanes), one(next_lanes), one(sums), one(next_sums), one(pulls), one(before), one(now), one(next);
  }
};

/// Directions by averaging of area vectors over the net.
class DirectionFilter {
 public:
  DirectionFilter(const SurfaceNet& net, Scratch& scratch)
      : net_(net),
        count_(net.vertices.size()),
        scratch_(scratch),
        sums_(scratch.sums.data()),
        next_(scratch.next_sums.data()) {}

  void filter(std::vector<Vec4i>& directions) {
    directions.resize(count_);
    first_mean(directions);
    for (int mean = 1; mean < kMeans; ++mean) {
      check_task();
      for (int step = 1; step < kStepsOfMean; ++step) {
        for (std::size_t v = 0; v < count_; ++v) next_[v] = sum(v);
        std::swap(sums_, next_);
      }
      for (std::size_t v = 0; v < count_; ++v) next_[v] = take_mean(sum(v), directions[v]);
      std::swap(sums_, next_);
    }
  }

 private:
  /// Sums of unit vectors of four steps, three lanes of 16 bits in the arithmetic sum of a word.
  static constexpr int kLaneBits = 16;

  [[nodiscard]] static std::int64_t packed(std::int64_t x, std::size_t lane) {
    return x * (std::int64_t{1} << kLaneBits * lane);
  }
  [[nodiscard]] static Vec4i unpacked(std::int64_t lanes) {
    Vec4i result{};
    for (std::size_t a = 0; a < 3; ++a) {
      result[a] = static_cast<std::int16_t>(lanes & 0xffff);
      lanes = (lanes - result[a]) >> kLaneBits;
    }
    return result;
  }

  void first_mean(std::vector<Vec4i>& directions) {
    std::int64_t *now = scratch_.lanes.data(), *next = scratch_.next_lanes.data();
    for (std::size_t v = 0; v < count_; ++v)
      now[v] = packed(net_.vertices[v].first_is_inside() ? 1 : -1, net_.vertices[v].axis());
    for (int step = 0; step < kStepsOfMean; ++step) {
      for (std::size_t v = 0; v < count_; ++v) {
        const auto& [p, q, r, s] = net_.neighbours[v];
        next[v] = now[v] + now[p] + now[q] + now[r] + now[s];
      }
      std::swap(now, next);
    }
    for (std::size_t v = 0; v < count_; ++v) {
      Vec4i total = unpacked(now[v]);
      for (std::size_t a = 0; a < 3; ++a) total[a] *= kOne;
      directions[v] = {};
      directions[v][net_.vertices[v].axis()] = net_.vertices[v].first_is_inside() ? kOne : -kOne;
      sums_[v] = take_mean(total, directions[v]);
    }
  }

  [[nodiscard]] Vec4i sum(std::size_t v) const {
    const auto& neighbours = net_.neighbours[v];
    const Vec4i &o = sums_[v], &p = sums_[neighbours[0]], &q = sums_[neighbours[1]],
                &r = sums_[neighbours[2]], &s = sums_[neighbours[3]];
    Vec4i total;
    for (std::size_t a = 0; a < 4; ++a) total[a] = o[a] + p[a] + q[a] + r[a] + s[a];
    return total;
  }
  [[nodiscard]] static Vec4i take_mean(Vec4i total, Vec4i& direction) {
    for (std::size_t a = 0; a < 3; ++a) total[a] /= kMean;
    if (std::abs(total[0]) + std::abs(total[1]) + std::abs(total[2]) >= kMinLength) direction = total;
    return total;
  }

  const SurfaceNet& net_;
  std::size_t count_;
  Scratch& scratch_;
  Vec4i *sums_, *next_;
};

/// Moves vertices along their edges until the net is perpendicular to its directions.
class Relaxation {
 public:
  Relaxation(const SurfaceNet& net, const std::vector<Vec4i>& directions, Scratch& scratch)
      : net_(net), directions_(directions), scratch_(scratch) {}

  void relax(std::vector<std::uint8_t>& offsets) {
    const std::size_t count = net_.vertices.size();
    std::int16_t *before = scratch_.before.data(), *now = scratch_.now.data(), *next = scratch_.next.data();
    std::fill_n(before, count, std::int16_t{0});
    Links links{};
    for (std::size_t first = 0; first < count; first += kBlock) {
      const std::size_t in_block = std::min(kBlock, count - first);
      gather(first, in_block, links);
      find_pulls(first, in_block, links);
    }
    for (std::size_t v = 0; v < count; ++v) now[v] = relaxed(0, kOmega[0], scratch_.pulls[v].constant);
    for (std::size_t step = 1; step < kRelaxations; ++step) {
      check_task();
      relax_once(step + 1 < kRelaxations ? before : now, now, static_cast<std::int16_t>(kOmega[step]), next);
      std::swap(before, now);
      std::swap(now, next);
    }
    offsets.resize(count);
    for (std::size_t v = 0; v < count; ++v)
      offsets[v] = static_cast<std::uint8_t>(128 + (now[v] + (now[v] < 0 ? -8 : 8)) / 16);
  }

 private:
  /// Blocks of sums, so that compilers use vectors for what follows them.
  void relax_once(const std::int16_t* from, const std::int16_t* now, std::int16_t omega,
                  std::int16_t* next) const {
    constexpr std::size_t kSums = 256;
    std::array<std::int32_t, kSums> sums;
    for (std::size_t first = 0; first < net_.vertices.size(); first += kSums) {
      const std::size_t count = std::min(kSums, net_.vertices.size() - first);
      for (std::size_t n = 0; n < count; ++n) {
        const auto& [p, q, r, s] = net_.neighbours[first + n];
        const Pull& pull = scratch_.pulls[first + n];
        sums[n] = pull.constant + pull.weights[0] * now[p] + pull.weights[1] * now[q] +
                  pull.weights[2] * now[r] + pull.weights[3] * now[s];
      }
      const std::int16_t* const origin = from + first;
      std::int16_t* const to = next + first;
      for (std::size_t n = 0; n < count; ++n) to[n] = relaxed(origin[n], omega, sums[n]);
    }
  }

  [[nodiscard]] static std::int16_t relaxed(std::int16_t from, std::int16_t omega, std::int32_t sum) {
    const auto limited = [](std::int32_t x, std::int32_t limit) {  // without branches
      x = x < -limit ? -limit : x;
      return static_cast<std::int16_t>(x > limit ? limit : x);
    };
    const std::int16_t step = static_cast<std::int16_t>(limited(shifted<11>(sum), kMaxStep) - from);
    return limited(from + shifted<12>(step * omega), kMaxOffset);
  }

  static constexpr std::size_t kBlock = 64;
  template <typename Number>
  using Lanes = std::array<Number, kBlock>;

  /// Components of the sums of directions of a block of links, along the edges and towards the neighbours.
  struct Links {
    std::array<Lanes<std::int32_t>, 4> along, beside;  // [slot]
    Lanes<std::int32_t> bits, kinds;                   // all bits of the absolute values; kinds of slots
  };

  void gather(std::size_t first, std::size_t count, Links& links) const {
    for (std::size_t n = 0; n < count; ++n) {
      const std::size_t v = first + n;
      const auto& neighbours = net_.neighbours[v];
      const std::size_t a = net_.vertices[v].axis(), b = a == 2 ? 0 : a + 1, c = b == 2 ? 0 : b + 1;
      const Vec4i& own = directions_[v];
      const std::int32_t sign = net_.vertices[v].first_is_inside() ? 1 : -1;
      std::int32_t bits = 1;
      for (std::size_t slot = 0; slot < 4; ++slot) {
        const Vec4i& other = directions_[neighbours[slot]];
        const std::size_t l = slot < 2 ? b : c;
        const std::int32_t along = sign * (own[a] + other[a]), beside = sign * (own[l] + other[l]);
        bits |= std::abs(along) | std::abs(beside);
        links.along[slot][n] = along;
        links.beside[slot][n] = (slot & 1) != 0 ? -beside : beside;
      }
      links.bits[n] = bits;
      links.kinds[n] = net_.kinds[v];
    }
  }

  /// Pulls of a block, without branches, so that compilers use vectors. Sums and products are whole numbers
  /// below 2^53, and exact; quotients by powers of two are rounded once, towards zero.
  void find_pulls(std::size_t first, std::size_t count, const Links& links) {
    Lanes<float> scale;
    for (std::size_t n = 0; n < kBlock; ++n) {  // 2^(kWeightBits - bit length), from the exponent of a float
      const std::int32_t exponent = std::bit_cast<std::int32_t>(static_cast<float>(links.bits[n])) >> 23;
      scale[n] = std::bit_cast<float>((2 * 127 + kWeightBits - 1 - exponent) << 23);
    }
    Lanes<std::int32_t> total{}, constant{};
    std::array<Lanes<std::int32_t>, 4> weights;
    for (std::size_t slot = 0; slot < 4; ++slot) {
      const std::int32_t side = (slot & 1) != 0 ? -1 : 0;  // as a mask
      for (std::size_t n = 0; n < kBlock; ++n) {
        const auto alpha = static_cast<std::int32_t>(scale[n] * static_cast<float>(links.along[slot][n]));
        const auto beta = static_cast<std::int32_t>(scale[n] * static_cast<float>(links.beside[slot][n]));
        const std::int32_t kind = links.kinds[n] >> 2 * slot & 3;
        const std::int32_t is_parallel = kind == 0 ? -1 : 0, is_low = kind == 1 ? -1 : 0,
                           is_high = kind == 2 ? -1 : 0;
        total[n] += alpha;
        constant[n] += beta + (is_parallel & beta) + (is_high & alpha) - (is_low & alpha);
        weights[slot][n] = (is_parallel & alpha) + ((is_low | is_high) & ((beta ^ side) - side));
      }
    }
    Lanes<double> inverse;
    for (std::size_t n = 0; n < kBlock; ++n) {
      const std::int32_t divisor = total[n] > 0 ? total[n] + 1024 : 1 << 30;  // then 0
      inverse[n] = static_cast<std::int32_t>(static_cast<double>(1 << 29) / static_cast<double>(divisor));
    }
    for (std::size_t n = 0; n < kBlock; ++n)
      constant[n] =
          static_cast<std::int32_t>(static_cast<double>(constant[n]) * inverse[n] * (1.0 / (1 << 7)));
    for (auto& of_slot : weights) {
      for (std::size_t n = 0; n < kBlock; ++n)
        of_slot[n] =
            static_cast<std::int32_t>(static_cast<double>(of_slot[n]) * inverse[n] * (1.0 / (1 << 18)));
    }
    for (std::size_t n = 0; n < count; ++n) {
      Pull& pull = scratch_.pulls[first + n];
      pull.constant = constant[n];
      for (std::size_t slot = 0; slot < 4; ++slot)
        pull.weights[slot] = static_cast<std::int16_t>(weights[slot][n]);
    }
  }

  static constexpr int kWeightBits = 14;

  const SurfaceNet& net_;
  const std::vector<Vec4i>& directions_;
  Scratch& scratch_;
};

}  // namespace

SmoothedNet smooth(const SurfaceNet& net, SmoothedNet reused, bool with_offsets) {
  SmoothedNet result = std::move(reused);
  Scratch& scratch = Scratch::of_thread(net.vertices.size());
  DirectionFilter(net, scratch).filter(result.directions);
  if (with_offsets) Relaxation(net, result.directions, scratch).relax(result.offsets);
  scratch.shrink();
  return result;
}

}  // namespace splatlas

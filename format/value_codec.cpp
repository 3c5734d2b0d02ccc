// A voxel is predicted by the median of seven predictors (its three neighbours, the three planes through
// them, and the trilinear one) from the voxels of its group that come before it in memory. How much these
// differ from one another tells how far off that may be: residuals are sorted into buckets by it, so that
// bytes of one distribution lie together. What the decoder needs, it has decoded.
#include "format/value_codec.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdlib>
#include <cstring>
#include <limits>

namespace splatlas {
namespace {

constexpr std::size_t kBuckets = 16;
constexpr std::size_t kCountsBytes = kBuckets * sizeof(std::uint32_t);
constexpr std::int32_t kAbsent = -1;  // not in the group, or not decoded yet
/// Of a slice of the box, with a voxel around it: two such slices are held.
constexpr std::uint64_t kMaxSliceVoxels = std::uint64_t{1} << 24;

std::uint64_t slice_voxels(const IndexBox& box) {
  return static_cast<std::uint64_t>(box.last[0] - box.first[0] + 3) *
         static_cast<std::uint64_t>(box.last[1] - box.first[1] + 3);
}

/// std::min() and std::max() of small numbers, never as branches: which of two predictors is less is
/// anybody's guess, and a wrong guess costs more than the rest of a voxel.
std::int32_t least(std::int32_t a, std::int32_t b) {
  const std::int32_t difference = a - b;
  return b + (difference & difference >> 31);
}
std::int32_t most(std::int32_t a, std::int32_t b) {
  const std::int32_t difference = a - b;
  return a - (difference & difference >> 31);
}

/// Sorts two.
void order(std::int32_t& a, std::int32_t& b) {
  const std::int32_t low = least(a, b);
  b += a - low;
  a = low;
}

/// The voxels that a prediction uses; named by what they are from it: i, j, k one less (ij: both), or one
/// more along i or j (up).
struct Neighbours {
  std::int32_t i, j, k, ij, ik, jk, ijk, i_up_j, i_up_k, j_up_k;

  [[nodiscard]] bool all_there() const {
    return (i | j | k | ij | ik | jk | ijk | i_up_j | i_up_k | j_up_k) >= 0;
  }
};

struct Prediction {
  std::int32_t value;
  std::size_t bucket;
};

/// Sums of differences from which on the last bucket takes all.
constexpr std::uint32_t kManyDifferences = 128;

/// Half octaves.
constexpr std::uint8_t bucket_of(std::uint32_t differences) {
  if (differences == 0) return 0;
  const auto octave = static_cast<unsigned>(std::bit_width(differences)) - 1;
  const unsigned half = octave == 0 ? 0 : differences >> (octave - 1) & 1;
  return static_cast<std::uint8_t>(std::min<std::size_t>(2 * octave + half + 1, kBuckets - 1));
}
constexpr auto kBucketOf = [] {
  std::array<std::uint8_t, kManyDifferences + 1> buckets{};
  for (std::uint32_t d = 0; d < buckets.size(); ++d) buckets[d] = bucket_of(d);
  return buckets;
}();
static_assert(bucket_of(kManyDifferences) == kBuckets - 1);

/// The median of i, j, k, i + j - ij, i + k - ik, j + k - jk and i + j + k - ij - ik - jk + ijk. What does
/// not need i, the voxel decoded last, is done first: four of the seven are i and more, three are without it,
/// both are sorted, and of two sorted lists the fourth is the least of the ways to take four from them.
Prediction predict_inside(const Neighbours& n, std::int32_t highest) {
  std::int32_t a0 = 0, a1 = n.j - n.ij, a2 = n.k - n.ik, a3 = n.j + n.k - n.ij - n.ik - n.jk + n.ijk;
  order(a0, a1), order(a2, a3), order(a0, a2), order(a1, a3), order(a1, a2);
  std::int32_t b0 = n.j, b1 = n.k, b2 = n.j + n.k - n.jk;
  order(b0, b1), order(b1, b2), order(b0, b1);
  const std::int32_t value =
      least(least(n.i + a3, most(n.i + a2, b0)), least(most(n.i + a1, b1), most(n.i + a0, b2)));
  const std::int32_t without_i = std::abs(n.j - n.ij) + std::abs(n.k - n.ik) + std::abs(n.j - n.jk) +
                                 std::abs(n.k - n.jk) + std::abs(n.i_up_j - n.j) + std::abs(n.i_up_k - n.k) +
                                 std::abs(n.j_up_k - n.k);
  const auto differences =
      static_cast<std::uint32_t>(without_i + std::abs(n.i - n.ij) + std::abs(n.i - n.ik));
  return {least(most(value, 0), highest), kBucketOf[std::min(differences, kManyDifferences)]};
}

/// Where the group ends, what is absent is made up from what is there.
Prediction predict(Neighbours n, std::int32_t highest) {
  if (n.all_there()) return predict_inside(n, highest);
  const std::int32_t any = n.i >= 0 ? n.i : n.j >= 0 ? n.j : n.k;
  if (any < 0) {
    for (const std::int32_t diagonal : {n.i_up_j, n.ij, n.ik, n.jk}) {
      if (diagonal >= 0) return {diagonal, kBuckets - 1};
    }
    return {0, kBuckets - 1};
  }
  const auto fill = [](std::int32_t& value, std::int32_t with) {
    if (value < 0) value = with;
  };
  fill(n.i, any), fill(n.j, any), fill(n.k, any);
  fill(n.ij, (n.i + n.j) / 2), fill(n.ik, (n.i + n.k) / 2), fill(n.jk, (n.j + n.k) / 2);
  fill(n.ijk, (n.ij + n.ik + n.jk) / 3);
  fill(n.i_up_j, n.j), fill(n.i_up_k, n.k), fill(n.j_up_k, n.k);
  return predict_inside(n, highest);
}

/// Two slices of the box, each with a voxel around it, kAbsent where nothing was put.
class SliceWindow {
 public:
  explicit SliceWindow(const IndexBox& box)
      : box_(box), width_(box.last[0] - box.first[0] + 3), now_(slice_voxels(box), kAbsent), before_(now_) {}

  /// The runs that follow lie in scanline (j, k); scanlines come in order.
  void go_to(std::int64_t j, std::int64_t k) {
    if (k != k_) {
      clear(before_, rows_before_);
      std::swap(now_, before_);
      std::swap(rows_now_, rows_before_);
      if (k != k_ + 1) clear(before_, rows_before_);
      k_ = k;
    }
    j_ = (j - box_.first[1] + 1) * width_;
    if (rows_now_.empty() || rows_now_.back() != j_) rows_now_.push_back(j_);
  }

  /// Puts code(prediction) at voxels begin to end - 1 of the scanline.
  template <typename Code>
  void code_run(std::int64_t begin, std::int64_t end, std::int32_t highest, Code&& code) {
    std::int32_t* now = now_.data() + j_ + begin - box_.first[0] + 1;
    const std::int32_t* const last = now + (end - begin);
    const std::int32_t* above = now - width_;
    const std::int32_t* back = before_.data() + (now - now_.data());
    const std::int32_t* back_above = back - width_;
    const std::int32_t* back_below = back + width_;
    // What the next voxel has on one side the one after it has on the other.
    Neighbours n{now[-1], 0, 0, above[-1], back[-1], 0, back_above[-1], above[0], back[0], 0};
    for (; now != last; ++now) {
      n.j = n.i_up_j, n.k = n.i_up_k, n.jk = *back_above++, n.j_up_k = *back_below++;
      n.i_up_j = *++above, n.i_up_k = *++back;
      const std::int32_t value = code(predict(n, highest));
      *now = value;
      n.i = value, n.ij = n.j, n.ik = n.k, n.ijk = n.jk;
    }
  }

 private:
  /// Only what was written: boxes may be large and hold little.
  void clear(std::vector<std::int32_t>& slice, std::vector<std::int64_t>& rows) const {
    for (const std::int64_t row : rows) std::fill_n(slice.begin() + row, width_, kAbsent);
    rows.clear();
  }

  const IndexBox box_;
  const std::int64_t width_;
  std::vector<std::int32_t> now_, before_;
  std::vector<std::int64_t> rows_now_, rows_before_;  // where rows begin that were written
  std::int64_t k_ = -2, j_ = 0;
};

/// Calls code(prediction) for every voxel; it gives the value.
template <typename Code>
void walk(const GroupVoxels& group, std::int32_t highest, Code&& code) {
  SliceWindow window(group.box);
  for (const ClassSpan& span : group.spans) {
    const auto scanline = static_cast<std::int64_t>(span.run.scanline);
    window.go_to(scanline % group.rows, scanline / group.rows);
    const std::int64_t begin = span.run.start;
    window.code_run(begin, begin + span.run.length, highest, code);
  }
}

/// Values from 0 on, whatever their type: signed ones begin at their least.
std::int32_t offset_of(VoxelType type) {
  return type == VoxelType::kInt8 ? 0x80 : type == VoxelType::kInt16 ? 0x8000 : 0;
}
std::int32_t highest_of(VoxelType type) {
  return bytes_of(type) == 1 ? 0xff : 0xffff;
}

/// Small differences of either sign, modulo the type's range, as small numbers.
std::uint32_t fold(std::int32_t difference, std::int32_t highest) {
  const std::int32_t half = (highest + 1) / 2;
  const std::int32_t d = ((difference + half) & highest) - half;
  return static_cast<std::uint32_t>(d >= 0 ? 2 * d : -2 * d - 1);
}
std::int32_t unfold(std::uint32_t code) {
  return static_cast<std::int32_t>(code >> 1) ^ -static_cast<std::int32_t>(code & 1);
}

bool spans_fit(const GroupVoxels& group) {
  const IndexBox& box = group.box;
  std::uint64_t voxels = 0;
  for (const ClassSpan& span : group.spans) {
    const auto scanline = static_cast<std::int64_t>(span.run.scanline);
    const std::int64_t j = scanline % group.rows, k = scanline / group.rows;
    if (span.run.start < box.first[0] || std::int64_t{span.run.start} + span.run.length - 1 > box.last[0] ||
        j < box.first[1] || j > box.last[1] || k < box.first[2] || k > box.last[2]) {
      return false;
    }
    voxels += span.run.length;
  }
  return voxels == group.voxels;
}

}  // namespace

bool predicts_values(VoxelType type, const IndexBox& box, std::uint64_t voxels) {
  const bool is_integer = type == VoxelType::kUInt8 || type == VoxelType::kInt8 ||
                          type == VoxelType::kUInt16 || type == VoxelType::kInt16;
  return is_integer && voxels > 0 && voxels <= std::numeric_limits<std::uint32_t>::max() &&
         slice_voxels(box) <= kMaxSliceVoxels;
}

std::uint64_t value_code_bytes(VoxelType type, const IndexBox& box, std::uint64_t voxels) {
  return voxels * bytes_of(type) + (predicts_values(type, box, voxels) ? kCountsBytes : 0);
}

std::vector<std::byte> encode_values(const GroupVoxels& group, VoxelType type,
                                     std::span<const std::byte> values) {
  if (!predicts_values(type, group.box, group.voxels)) return {values.begin(), values.end()};
  const std::size_t value_bytes = bytes_of(type);
  const std::int32_t highest = highest_of(type), offset = offset_of(type);
  std::array<std::vector<std::uint16_t>, kBuckets> residuals;
  const std::byte* next = values.data();
  walk(group, highest, [&](const Prediction& prediction) {
    std::uint16_t bits = 0;
    std::memcpy(&bits, next, value_bytes);
    next += value_bytes;
    const std::int32_t value = (bits + offset) & highest;
    residuals[prediction.bucket].push_back(
        static_cast<std::uint16_t>(fold(value - prediction.value, highest)));
    return value;
  });
  std::vector<std::byte> code(kCountsBytes);
  for (std::size_t b = 0; b < kBuckets; ++b) {
    const auto count = static_cast<std::uint32_t>(residuals[b].size());
    std::memcpy(code.data() + b * sizeof count, &count, sizeof count);
  }
  for (std::size_t byte = 0; byte < value_bytes; ++byte) {
    for (const std::vector<std::uint16_t>& bucket : residuals) {
      for (const std::uint16_t residual : bucket)
        code.push_back(static_cast<std::byte>(residual >> 8 * byte));
    }
  }
  return code;
}

Result<std::vector<std::byte>> decode_values(const GroupVoxels& group, VoxelType type,
                                             std::span<const std::byte> code) {
  const auto invalid = [](const char* what) { return fail(ErrorCode::kInvalidAtlas, what); };
  if (!spans_fit(group)) return invalid("boxes are not those of the runs");
  if (!predicts_values(type, group.box, group.voxels))
    return std::vector<std::byte>(code.begin(), code.end());
  std::array<std::uint32_t, kBuckets> counts{};
  std::memcpy(counts.data(), code.data(), kCountsBytes);
  std::array<const std::byte*, kBuckets> next{}, end{};
  std::uint64_t sum = 0;
  for (std::size_t b = 0; b < kBuckets; ++b) {
    if (counts[b] > group.voxels - sum) return invalid("buckets hold more than the voxels");
    next[b] = code.data() + kCountsBytes + sum;
    sum += counts[b];
    end[b] = code.data() + kCountsBytes + sum;
  }
  if (sum != group.voxels) return invalid("buckets hold less than the voxels");

  const std::size_t value_bytes = bytes_of(type);
  const std::int32_t highest = highest_of(type), offset = offset_of(type);
  const std::size_t to_high_byte = value_bytes == 2 ? group.voxels : 0;
  std::vector<std::byte> values(group.voxels * value_bytes);
  std::byte* to = values.data();
  bool ran_out = false;
  walk(group, highest, [&](const Prediction& prediction) {
    const std::byte*& from = next[prediction.bucket];
    if (from == end[prediction.bucket]) {
      ran_out = true;
      return 0;
    }
    auto residual = std::to_integer<std::uint32_t>(*from);
    if (to_high_byte != 0) residual |= std::to_integer<std::uint32_t>(from[to_high_byte]) << 8;
    ++from;
    const std::int32_t value = (prediction.value + unfold(residual)) & highest;
    const auto bits = static_cast<std::uint16_t>(value - offset);
    std::memcpy(to, &bits, value_bytes);
    to += value_bytes;
    return value;
  });
  if (ran_out) return invalid("buckets do not hold what the voxels call for");
  return values;
}

}  // namespace splatlas

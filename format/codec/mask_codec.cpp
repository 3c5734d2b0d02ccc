// A 3D variant of JBIG2's generic region coding: twelve preceding neighbours of a voxel select one of 4096
// adaptive probabilities. A formula of the neighbours gives the initial probabilities, so that small
// structures compress well, too.
#include "format/codec/mask_codec.h"

#include <algorithm>
#include <cmath>

#include "format/result_macros.h"
#include "format/tasks/task_control.h"

namespace splatlas {
namespace {

/// Adaptive probability of a set bit, in units of 1/65536, and the number of observed bits.
struct AdaptiveBit {
  static constexpr std::int64_t kMin = 16, kMax = 65536 - kMin;
  static constexpr std::uint16_t kMaxSeen = 255;

  std::uint16_t probability = 32768;
  std::uint16_t seen = 0;

  void learn(bool bit) {
    // Running mean of the first kMaxSeen bits, then an exponential moving average.
    const std::int64_t difference = (bit ? 65535 : 0) - std::int64_t{probability};
    const std::int64_t moved = probability + (difference * kShares[seen] >> 16);
    probability = static_cast<std::uint16_t>(std::clamp(moved, kMin, kMax));
    seen = static_cast<std::uint16_t>(seen + (seen < kMaxSeen ? 1 : 0));
  }

 private:
  static constexpr auto kShares = [] {  // 1 / (seen + 1), in units of 1/65536
    std::array<std::int32_t, kMaxSeen + 1> shares{};
    for (std::size_t n = 0; n < shares.size(); ++n)
      shares[n] = static_cast<std::int32_t>(32768 / (n + 1) * 2);
    return shares;
  }();
};

/// Renormalization threshold: ranges keep at least 8 bits more than probabilities.
constexpr std::uint32_t kMinRange = std::uint32_t{1} << 24;

/// Adaptive binary range coder (Martin 1979, "Range encoding"), with LZMA's carry propagation.
class RangeEncoder {
 public:
  void encode(AdaptiveBit& model, bool bit) {
    const std::uint32_t bound = (range_ >> 16) * model.probability;
    if (bit) {
      range_ = bound;
    } else {
      low_ += bound;
      range_ -= bound;
    }
    model.learn(bit);
    for (; range_ < kMinRange; range_ <<= 8) shift_out();
  }

  /// Flushes the code, without its trailing zeros. The encoder cannot be used afterwards.
  [[nodiscard]] std::vector<std::byte> finish() {
    for (int n = 0; n < 5; ++n) shift_out();
    bytes_.erase(bytes_.begin());  // always 0
    while (!bytes_.empty() && bytes_.back() == std::byte{0}) bytes_.pop_back();
    return std::move(bytes_);
  }

 private:
  void shift_out() {
    constexpr std::uint64_t kCarry = std::uint64_t{1} << 32;
    if (low_ < kCarry - kMinRange || low_ >= kCarry) {
      const auto carry = static_cast<std::uint8_t>(low_ >> 32);
      for (; pending_ > 0; --pending_, cache_ = 0xff)
        bytes_.push_back(static_cast<std::byte>(cache_ + carry));
      cache_ = static_cast<std::uint8_t>(low_ >> 24);
    }
    ++pending_;
    low_ = (low_ & (kMinRange - 1)) << 8;
  }

  std::uint64_t low_ = 0;
  std::uint32_t range_ = 0xffffffff;
  std::uint8_t cache_ = 0;
  std::uint64_t pending_ = 1;  // bytes that a carry may still change: cache_, then 0xff
  std::vector<std::byte> bytes_;
};

/// Decoder. Safe on untrusted bytes; reads zeros after their end.
class RangeDecoder {
 public:
  explicit RangeDecoder(std::span<const std::byte> bytes) : bytes_(bytes) {
    for (int n = 0; n < 4; ++n) code_ = code_ << 8 | next();
  }

  [[nodiscard]] bool decode(AdaptiveBit& model) {
    const std::uint32_t bound = (range_ >> 16) * model.probability;
    const bool bit = code_ < bound;
    if (bit) {
      range_ = bound;
    } else {
      code_ -= bound;
      range_ -= bound;
    }
    model.learn(bit);
    for (; range_ < kMinRange; range_ <<= 8) code_ = code_ << 8 | next();
    return bit;
  }

  /// True if all bytes were read.
  [[nodiscard]] bool at_end() const { return at_ >= bytes_.size(); }

 private:
  std::uint32_t next() {
    const std::size_t at = at_++;
    return at < bytes_.size() ? std::to_integer<std::uint32_t>(bytes_[at]) : 0;
  }

  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
  std::uint32_t range_ = 0xffffffff, code_ = 0;
};

constexpr std::uint64_t kMaxSliceVoxels = std::uint64_t{1} << 24;
constexpr std::uint64_t kMaxBoxVoxels = std::uint64_t{1} << 28;  // limits decoding to seconds, for any mask
constexpr std::uint64_t kMaxBoxVoxelsPerVoxel = 64;              // box voxels per covered voxel

constexpr std::size_t kNeighbours = 12;
/// Contribution of a covered neighbour to the log odds of a covered voxel, in quarters. Offsets of the
/// neighbours along scanline, rows and slices:
///   (-1, 0, 0), (-2, 0, 0), (0, -1, 0), (-1, -1, 0), (1, -1, 0), (0, -2, 0),
///   (0, 0, -1), (-1, 0, -1), (1, 0, -1), (0, -1, -1), (0, 1, -1), (0, 0, -2)
constexpr std::array<int, kNeighbours> kVotes{9, -1, 7, -1, 4, -1, 5, -2, 3, -2, 5, -3};
constexpr std::uint16_t kTrust = 4;  // initial probabilities count as this many observed bits

using Models = std::array<AdaptiveBit, std::size_t{1} << kNeighbours>;

Models make_first_models() {
  Models models;
  for (std::size_t context = 0; context < models.size(); ++context) {
    int votes = 0;
    for (std::size_t n = 0; n < kNeighbours; ++n) votes += context >> n & 1 ? kVotes[n] : -kVotes[n];
    const double probability = std::round(65536 / (1 + std::exp(-0.25 * votes)));
    models[context].probability = static_cast<std::uint16_t>(std::clamp(probability, 64.0, 65472.0));
    models[context].seen = kTrust;
  }
  return models;
}

const Models& first_models() {
  static const Models kModels = make_first_models();
  return kModels;
}

/// Sliding window of three slices of a box, coded scanline by scanline along an axis; one byte per voxel.
class MaskWindow {
 public:
  MaskWindow(const IndexBox& box, const Index3& size, Axis axis) : order_(ScanOrder::of(axis)), box_(box) {
    rows_of_grid_ = static_cast<std::uint64_t>(size[order_.row_axis]);
    width_ = extent(order_.scan_axis);
    rows_ = extent(order_.row_axis);
    slices_ = extent(order_.slice_axis);
    // Pad rows by two before and one after, and scanlines by two voxels before and one after.
    stride_ = width_ + 3;
    for (auto& slice : around_) slice.assign(stride_ * (rows_ + 3), 0);
    contexts_.resize(width_);
  }

  [[nodiscard]] std::size_t width() const { return width_; }
  [[nodiscard]] std::size_t rows() const { return rows_; }
  [[nodiscard]] std::size_t slices() const { return slices_; }

  /// Scanline number in the grid.
  [[nodiscard]] std::uint64_t scanline(std::size_t row, std::size_t slice) const {
    return (static_cast<std::uint64_t>(box_.first[order_.slice_axis]) + slice) * rows_of_grid_ +
           static_cast<std::uint64_t>(box_.first[order_.row_axis]) + row;
  }
  [[nodiscard]] std::uint32_t first_voxel() const {
    return static_cast<std::uint32_t>(box_.first[order_.scan_axis]);
  }

  void next_slice() {
    std::rotate(around_.begin(), around_.end() - 1, around_.end());
    std::fill(around_[0].begin(), around_[0].end(), std::uint8_t{0});
  }

  /// Calls code(context, n) for every voxel n of a scanline. It returns true for covered voxels.
  template <typename Code>
  void code_scanline(std::size_t row, Code&& code) {
    const std::size_t at = (row + 2) * stride_ + 2;
    std::uint8_t* const now = around_[0].data() + at;
    const std::uint8_t* const above = now - stride_;
    const std::uint8_t* const above_that = above - stride_;
    const std::uint8_t* const back = around_[1].data() + at;
    const std::uint8_t* const back_above = back - stride_;
    const std::uint8_t* const back_below = back + stride_;
    const std::uint8_t* const back_that = around_[2].data() + at;
    for (std::size_t n = 0; n < width_; ++n) {
      contexts_[n] = static_cast<std::uint16_t>(above[n] << 2 | *(above + n - 1) << 3 | above[n + 1] << 4 |
                                                above_that[n] << 5 | back[n] << 6 | *(back + n - 1) << 7 |
                                                back[n + 1] << 8 | back_above[n] << 9 | back_below[n] << 10 |
                                                back_that[n] << 11);
    }
    unsigned before = 0;  // the two voxels before
    for (std::size_t n = 0; n < width_; ++n) {
      const bool covered = code(contexts_[n] | before, n);
      now[n] = covered ? 1 : 0;
      before = (before << 1 & 2) | now[n];
    }
  }

 private:
  [[nodiscard]] std::size_t extent(std::uint8_t axis) const {
    return static_cast<std::size_t>(box_.last[axis] - box_.first[axis] + 1);
  }

  const ScanOrder order_;
  const IndexBox box_;
  std::uint64_t rows_of_grid_ = 0;
  std::size_t width_ = 0, rows_ = 0, slices_ = 0, stride_ = 0;
  std::array<std::vector<std::uint8_t>, 3> around_;  // this slice, the one before, and the one before that
  std::vector<std::uint16_t> contexts_;              // [voxel]: without its scanline
};

tl::unexpected<Error> not_a_mask() {
  return invalid_atlas("invalid mask");
}

}  // namespace

bool codes_mask(const IndexBox& box, std::uint64_t voxels) {
  if (box.empty()) return false;
  std::array<std::uint64_t, 3> extent{};
  for (std::size_t a = 0; a < 3; ++a) extent[a] = static_cast<std::uint64_t>(box.last[a] - box.first[a] + 4);
  const std::uint64_t slice = extent[0] * extent[1], sides = std::max(extent[0], extent[1]) * extent[2];
  const std::uint64_t all = slice * extent[2];
  return std::max(slice, sides) <= kMaxSliceVoxels && all <= kMaxBoxVoxels &&
         all / kMaxBoxVoxelsPerVoxel <= voxels;
}

std::vector<std::byte> encode_mask(std::span<const Run> runs, const IndexBox& box, const Index3& size,
                                   Axis axis) {
  MaskWindow window(box, size, axis);
  Models models = first_models();
  RangeEncoder encoder;
  auto next = runs.begin();
  for (std::size_t slice = 0; slice < window.slices(); ++slice) {
    window.next_slice();
    for (std::size_t row = 0; row < window.rows(); ++row) {
      const std::uint64_t scanline = window.scanline(row, slice);
      window.code_scanline(row, [&](std::size_t context, std::size_t n) {
        const std::uint64_t at = window.first_voxel() + n;
        while (next != runs.end() && next->scanline == scanline &&
               at >= std::uint64_t{next->start} + next->length)
          ++next;
        const bool covered = next != runs.end() && next->scanline == scanline && at >= next->start;
        encoder.encode(models[context], covered);
        return covered;
      });
      while (next != runs.end() && next->scanline == scanline) ++next;
    }
  }
  std::vector<std::byte> bytes = encoder.finish();
  bytes.insert(bytes.begin(), kMaskMark);
  return bytes;
}

Result<ClassRuns> decode_mask(std::span<const std::byte> bytes, const IndexBox& box, const Index3& size,
                              Axis axis, std::uint64_t voxels) {
  if (bytes.empty() || bytes.front() != kMaskMark || !codes_mask(box, voxels)) return not_a_mask();
  MaskWindow window(box, size, axis);
  Models models = first_models();
  RangeDecoder decoder(bytes.subspan(1));
  ClassRuns runs;
  std::uint64_t found = 0;
  for (std::size_t slice = 0; slice < window.slices(); ++slice) {
    check_task();
    check_memory(3.0 * sizeof(Run) * static_cast<double>(runs.size()));
    window.next_slice();
    for (std::size_t row = 0; row < window.rows(); ++row) {
      bool was_covered = false;
      window.code_scanline(row, [&](std::size_t context, std::size_t n) {
        const bool covered = decoder.decode(models[context]);
        if (covered) {
          if (!was_covered)
            runs.push_back(
                {window.scanline(row, slice), window.first_voxel() + static_cast<std::uint32_t>(n), 0});
          ++runs.back().length;
          ++found;
        }
        was_covered = covered;
        return covered;
      });
      if (found > voxels) return not_a_mask();
    }
  }
  if (found != voxels || !decoder.at_end()) return not_a_mask();
  return runs;
}

}  // namespace splatlas

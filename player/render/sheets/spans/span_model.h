// Spans: merged runs of the selected classes with the optical properties of their voxels, and their buffers.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

#include "format/content/grid.h"
#include "format/tasks/thread_pool.h"
#include "player/render/decode/lit_voxels.h"

namespace splatlas {

/// Blocks [first, last) of a scanline.
struct Blocks {
  std::int64_t first = 0, last = 0;

  [[nodiscard]] bool contains(std::int64_t block) const { return first <= block && block < last; }
};

/// The parts of blocks before and behind others; either may be empty.
[[nodiscard]] inline std::array<Blocks, 2> parts_outside(const Blocks& all, const Blocks& hole) {
  if (hole.first >= hole.last) return {all, {all.last, all.last}};
  return {Blocks{all.first, std::clamp(hole.first, all.first, all.last)},
          Blocks{std::clamp(hole.last, all.first, all.last), all.last}};
}

/// Rows [first, last) of a slice; none at first.
struct RowRange {
  std::int64_t first = std::numeric_limits<std::int64_t>::max(), last = 0;

  [[nodiscard]] bool empty() const { return first >= last; }
  void include(const RowRange& other) {
    first = std::min(first, other.first);
    last = std::max(last, other.last);
  }
};

/// Growable array of floats, aligned to cache lines. clear() keeps its capacity.
class OpticalBuffer {
 public:
  OpticalBuffer() = default;
  /// An empty buffer on existing memory of `capacity` floats.
  OpticalBuffer(std::shared_ptr<float> room, std::size_t capacity)
      : floats_(std::move(room)), capacity_(capacity) {}
  OpticalBuffer(OpticalBuffer&& other) noexcept { *this = std::move(other); }
  OpticalBuffer& operator=(OpticalBuffer&& other) noexcept {
    floats_ = std::move(other.floats_);
    size_ = std::exchange(other.size_, 0);
    capacity_ = std::exchange(other.capacity_, 0);
    return *this;
  }
  ~OpticalBuffer() = default;
  [[nodiscard]] const float* data() const { return floats_.get(); }
  [[nodiscard]] float* data() { return floats_.get(); }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] std::size_t capacity() const { return capacity_; }
  void clear() { size_ = 0; }
  /// Appends uninitialised floats and returns a pointer to them. Throws std::bad_alloc.
  float* append(std::size_t floats) {
    if (size_ + floats > capacity_) grow(size_ + floats);
    size_ += floats;
    return floats_.get() + (size_ - floats);
  }
  /// Reduces the capacity to the size; the memory beyond belongs to the arena again.
  void fit() { capacity_ = size_; }

 private:
  void grow(std::size_t floats);

  std::shared_ptr<float> floats_;
  std::size_t size_ = 0, capacity_ = 0;
};

/// Arena of the buffers of successive selections. Page faults would cost more than writing, so that chunks
/// are reused. Many slices share a chunk, which may be backed by large pages.
class OpticalArena {
 public:
  /// Announces the total size of the next buffers, which decides their page size. They share no chunk with
  /// those before, which are usually freed soon.
  void expect(std::uint64_t bytes);
  /// An empty buffer with a capacity of at least `floats`. The caller fills it and passes it to settle().
  /// Throws std::bad_alloc. Thread-safe.
  [[nodiscard]] OpticalBuffer lend(std::size_t floats);
  /// Returns the unused capacity of a buffer to the arena. Thread-safe.
  void settle(OpticalBuffer& buffer);

  /// Bytes written so far, in use or not.
  [[nodiscard]] std::uint64_t bytes() const;
  /// Bytes that cannot be reused: those of chunks with at least one live buffer.
  [[nodiscard]] std::uint64_t bytes_in_use() const;
  /// Frees unused chunks until at most `bytes` of them remain.
  void trim(std::uint64_t bytes);

 private:
  static constexpr std::uint64_t kLargePages = std::uint64_t{1} << 20;
  struct Chunk;

  std::unique_ptr<std::mutex> mutex_ = std::make_unique<std::mutex>();
  std::vector<std::shared_ptr<Chunk>> chunks_;
  bool large_ = false;
};

/// The spans of one slice, built by SpanWriter.
struct SliceSpans {
  std::int64_t number = 0;                   ///< of the slice in the grid
  int emissions = 3;                         ///< 1 or 3
  std::int64_t first_row = 0, last_row = 0;  ///< spans are in rows [first_row, last_row) of the grid
  std::vector<std::uint32_t> first_span;     ///< last_row - first_row + 1 offsets; empty without spans
  std::vector<Span> spans;                   ///< by row, then position
  OpticalBuffer optics;                      ///< of all blocks; unlit in a SpanModel
  std::vector<BlockLights> lights;           ///< of blocks with lit voxels, ascending
  std::uint64_t voxels = 0;                  ///< selected voxels with an extinction above 0

  /// The spans of a row of the grid.
  [[nodiscard]] std::span<const Span> row(std::int64_t n) const {
    if (n < first_row || n >= last_row) return {};
    const std::uint32_t* first = &first_span[static_cast<std::size_t>(n - first_row)];
    return {spans.data() + first[0], spans.data() + first[1]};
  }
  /// Floats per block.
  [[nodiscard]] std::int64_t block_floats() const { return kBlock * (1 + emissions); }
  /// Lane of a voxel of a span, given by its position in the scanline: its number among those of all blocks.
  [[nodiscard]] static std::uint32_t lane_of(const Span& span, std::uint32_t voxel) {
    return voxel + ((span.offset - span.first_block) << kBlockBits);
  }
  /// Index in `optics` of the extinction of a voxel. The emissions follow at a stride of kBlock.
  [[nodiscard]] std::size_t place(std::uint32_t lane) const {
    return std::size_t{lane >> kBlockBits} * static_cast<std::size_t>(block_floats()) +
           (lane & static_cast<std::uint32_t>(kBlock - 1));
  }
  [[nodiscard]] std::size_t place(const Span& span, std::uint32_t voxel) const {
    return place(lane_of(span, voxel));
  }
};

/// All spans of a selection for one principal axis. Slices, rows and voxels are indices of the grid.
struct SpanModel {
  Axis axis = Axis::kZ;
  /// The selection's bounding box: slices [slice_first, slice_first + slice_count), and so on.
  std::int64_t slice_first = 0, slice_count = 0, row_first = 0, rows = 0, scan_first = 0, scan_voxels = 0;
  int emissions = 3;                    ///< of every slice
  std::array<float, 3> color{1, 1, 1};  ///< linear; of a volume with one emission
  /// Maximum extinction of the appearances, averaged over the selected voxels, 1/mm.
  double mean_densest_per_mm = 0;
  std::vector<SliceSpans> slices;  ///< by number; slices without spans may be missing
  std::uint64_t voxels = 0;

  /// Index of the first slice with at least this number.
  [[nodiscard]] std::size_t place_of(std::int64_t number) const {
    return static_cast<std::size_t>(std::ranges::lower_bound(slices, number, {}, &SliceSpans::number) -
                                    slices.begin());
  }
  /// The spans of a slice of the grid; null if there are none.
  [[nodiscard]] const SliceSpans* slice(std::int64_t number) const {
    const std::size_t place = place_of(number);
    if (place == slices.size() || slices[place].number != number || slices[place].spans.empty())
      return nullptr;
    return &slices[place];
  }
};

/// Copies rows of the grid; of each, only the blocks that `visible` names, without the content of those that
/// `hidden` names, unless these are empty. Multiplies the lit part of emissions by `factors[normal]`, 65536.
/// `lit` is overwritten and keeps its capacity; it has neither lights nor a voxel count.
void light_rows(const SliceSpans& slice, const RowRange& rows, std::span<const Blocks> visible,
                std::span<const Blocks> hidden, std::span<const float> factors, SliceSpans& lit);

}  // namespace splatlas

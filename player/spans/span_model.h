// Spans: merged runs of the selected classes with what their voxels emit and absorb, ready to be splatted.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "format/grid.h"
#include "format/system/thread_pool.h"
#include "format/unit_vector.h"
#include "player/spans/optical_buffer.h"

namespace splatlas {

/// Scanlines are cut into blocks of kBlock voxels, the first at voxel 0. The light of a block is kBlock
/// floats of extinction (1/mm), then kBlock of each emission (1/mm): one stream of memory, made for vectors.
/// Volumes of one colour have one emission, that of white (extinction times shade); others red, green and
/// blue.
inline constexpr int kBlockBits = 4;
inline constexpr std::int64_t kBlock = std::int64_t{1} << kBlockBits;

/// Consecutive blocks of a scanline that hold selected voxels; what is not selected emits and absorbs
/// nothing. The last voxel of the last block is always such a one, so that no footprint ends in another
/// block.
struct Span {
  std::uint32_t first_block = 0, blocks = 0;
  std::uint32_t voxels = 0;  ///< those with an extinction
  std::uint32_t offset = 0;  ///< of the light of the first block within the slice, in blocks
};

/// A voxel whose colour depends on the view: it lies on a boundary and is shaded by its normal (hybrid
/// shading).
struct ShadedVoxel {
  std::size_t place = 0;  ///< of its extinction
  PackedNormal normal = 0;
  std::array<float, 3> emission{};  ///< unshaded, 1/mm; white's first where there is one
};

/// The spans of one slice. Made by SpanWriter.
struct SliceSpans {
  int emissions = 3;                         ///< 1 or 3
  std::int64_t first_row = 0, last_row = 0;  ///< spans are in rows [first_row, last_row) of the grid
  std::vector<std::uint32_t> first_span;     ///< last_row - first_row + 1 offsets; empty without spans
  std::vector<Span> spans;                   ///< by row, then place
  OpticalBuffer light;                       ///< of all blocks
  std::vector<ShadedVoxel> shaded;
  std::uint64_t voxels = 0;  ///< selected voxels with an extinction above 0

  /// Of a row of the grid.
  [[nodiscard]] std::span<const Span> row(std::int64_t n) const {
    if (n < first_row || n >= last_row) return {};
    const std::uint32_t* first = &first_span[static_cast<std::size_t>(n - first_row)];
    return {spans.data() + first[0], spans.data() + first[1]};
  }
  /// Floats of light of a block.
  [[nodiscard]] std::int64_t block_floats() const { return kBlock * (1 + emissions); }
  /// Where a voxel of a span (by its place in the scanline) has its extinction; its emissions follow, kBlock
  /// further on each.
  [[nodiscard]] std::size_t place(const Span& span, std::uint32_t voxel) const {
    const std::uint32_t block = span.offset + (voxel >> kBlockBits) - span.first_block;
    return std::size_t{block} * static_cast<std::size_t>(block_floats()) +
           (voxel & static_cast<std::uint32_t>(kBlock - 1));
  }
};

/// All spans of a selection for one principal axis. Slices, rows and voxels are numbers of the grid.
struct SpanModel {
  Axis axis = Axis::kZ;
  /// The selection's box: slices [slice_first, slice_first + slices.size()), and so on.
  std::int64_t slice_first = 0, row_first = 0, rows = 0, scan_first = 0, scan_voxels = 0;
  int emissions = 3;                    ///< of every slice
  std::array<float, 3> color{1, 1, 1};  ///< linear; of the volume where it has one emission
  /// Extinction where looks are densest, 1/mm: the mean over the selected voxels.
  double mean_densest_per_mm = 0;
  std::vector<SliceSpans> slices;
  std::uint64_t voxels = 0;
  std::uint64_t shaded_voxels = 0;  ///< whose colour depends on the view
};

/// Bytes that a model of `voxels` selected voxels in `runs` runs takes at most, offsets of rows left out.
[[nodiscard]] std::uint64_t span_model_bytes(std::uint64_t voxels, std::uint64_t runs);

/// Multiplies the emission of shaded voxels by `light[normal]` (65536 entries): once per change of view.
void shade_spans(SpanModel& model, std::span<const float> light, ThreadPool& pool);

}  // namespace splatlas

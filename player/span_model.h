// Spans: merged runs of the selected classes with what their voxels emit and absorb, ready to be splatted.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "format/unit_vector.h"
#include "player/selected_runs.h"
#include "player/thread_pool.h"
#include "player/volume_looks.h"

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

struct FreeLight {
  void operator()(float* light) const;
};

/// The spans of one slice.
struct SliceSpans {
  int emissions = 3;                          ///< 1 or 3
  std::vector<std::uint32_t> first_span;      ///< rows + 1 offsets; empty when the slice has no span
  std::int64_t first_row = 0, last_row = 0;   ///< spans are in rows [first_row, last_row)
  std::vector<Span> spans;                    ///< by row, then place
  std::unique_ptr<float[], FreeLight> light;  ///< of all blocks, aligned to cache lines
  std::vector<ShadedVoxel> shaded;
  std::uint64_t voxels = 0;  ///< selected voxels with an extinction above 0

  /// Of row n, counted from the model's first; empty outside.
  [[nodiscard]] std::span<const Span> row(std::int64_t n) const {
    if (n < 0 || n + 1 >= static_cast<std::int64_t>(first_span.size())) return {};
    const std::uint32_t* first = &first_span[static_cast<std::size_t>(n)];
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

  /// Adds a voxel to the latest row, whose spans begin with number `first_of_row`. Voxels come in order.
  void add_voxel(std::size_t first_of_row, std::uint32_t voxel);
  /// Gives every span its place, and makes room for the light, all zero.
  void allocate_light();
  /// Sets first_row and last_row, once `first_span` is complete.
  void find_rows();
  /// Writes the unshaded light of a voxel, and says where and what it is, the normal left out.
  ShadedVoxel set_light(const Span& span, std::uint32_t voxel, const VolumeLook& look, const VoxelLook& seen);
  /// Floats of light, once there is room for it.
  [[nodiscard]] std::size_t light_floats() const {
    if (spans.empty()) return 0;
    return (std::size_t{spans.back().offset} + spans.back().blocks) *
           static_cast<std::size_t>(block_floats());
  }
};

/// All spans of a selection for one principal axis.
struct SpanModel {
  Axis axis = Axis::kZ;
  std::int64_t slice_first = 0, row_first = 0, rows = 0, scan_first = 0, scan_voxels = 0;
  int emissions = 3;                    ///< of every slice
  std::array<float, 3> color{1, 1, 1};  ///< linear; of the volume where it has one emission
  std::vector<SliceSpans> slices;
  std::uint64_t voxels = 0;
  std::uint64_t shaded_voxels = 0;  ///< whose colour depends on the view
};

/// Bytes that a model of `voxels` selected voxels in `runs` runs takes at most, offsets of rows left out.
[[nodiscard]] std::uint64_t span_model_bytes(std::uint64_t voxels, std::uint64_t runs);

/// Looks up what every selected voxel emits and absorbs (classified before interpolation) and packs it into
/// spans. `looks` and the plan's classes correspond. With `shade`, boundary voxels are listed for
/// shade_spans(). Cost: linear in the selected voxels; slices are built in parallel. Voxels without
/// extinction are left out.
[[nodiscard]] SpanModel build_spans(const SelectedRuns& selected, const DrawPlan& plan,
                                    std::span<const VolumeLook> looks, const Grid& grid,
                                    const ClassCache& cache, bool shade, ThreadPool& pool);

/// Multiplies the emission of shaded voxels by `light[normal]` (65536 entries): once per change of view.
void shade_spans(SpanModel& model, std::span<const float> light, ThreadPool& pool);

}  // namespace splatlas

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

/// What a voxel emits and absorbs: extinction in 1/mm, and emission (colour times extinction) in 1/mm.
enum class Plane : std::uint8_t { kExtinction = 0, kRed = 1, kGreen = 2, kBlue = 3 };
inline constexpr std::size_t kPlanes = 4;

/// Scanlines are cut into blocks of kBlock voxels, the first at voxel 0. The light of a block is kBlock
/// floats for each plane, one after the other: one stream of memory, made for vectors.
inline constexpr int kBlockBits = 4;
inline constexpr std::int64_t kBlock = std::int64_t{1} << kBlockBits;
inline constexpr std::int64_t kBlockFloats = kBlock * static_cast<std::int64_t>(kPlanes);

/// Consecutive blocks of a scanline that hold selected voxels; what is not selected emits and absorbs
/// nothing. The last voxel of the last block is always such a one, so that no footprint ends in another
/// block.
struct Span {
  std::uint32_t first_block = 0, blocks = 0;
  std::uint32_t voxels = 0;  ///< those with an extinction
  std::size_t offset = 0;    ///< of the light of the first block

  /// Where a voxel within the span (by its place in the scanline) has the light of the first plane; the other
  /// planes follow, kBlock further on each.
  [[nodiscard]] std::size_t place(std::uint32_t voxel) const {
    const std::uint32_t block = (voxel >> kBlockBits) - first_block;
    return offset + std::size_t{block} * static_cast<std::size_t>(kBlockFloats) +
           (voxel & static_cast<std::uint32_t>(kBlock - 1));
  }
};

/// A voxel whose colour depends on the view: it lies on a boundary and is shaded by its normal (hybrid
/// shading).
struct ShadedVoxel {
  std::size_t place = 0;  ///< of the light of the first plane
  PackedNormal normal = 0;
  std::array<float, 3> emission{};  ///< unshaded, 1/mm
};

struct FreeLight {
  void operator()(float* light) const;
};

/// The spans of one slice.
struct SliceSpans {
  std::vector<std::uint32_t> first_span;      ///< rows + 1 offsets; empty when the slice has no span
  std::vector<Span> spans;                    ///< by row, then place
  std::unique_ptr<float[], FreeLight> light;  ///< of all blocks, aligned for vectors
  std::vector<ShadedVoxel> shaded;
  std::uint64_t voxels = 0;  ///< selected voxels with an extinction above 0

  /// Adds a voxel to the latest row, whose spans begin with number `first_of_row`. Voxels come in order.
  void add_voxel(std::size_t first_of_row, std::uint32_t voxel);
  /// Gives every span its place, and makes room for the light, all zero.
  void allocate_light();
  /// Floats of light, once there is room for it.
  [[nodiscard]] std::size_t light_floats() const {
    if (spans.empty()) return 0;
    return spans.back().offset + std::size_t{spans.back().blocks} * static_cast<std::size_t>(kBlockFloats);
  }
};

/// All spans of a selection for one principal axis.
struct SpanModel {
  Axis axis = Axis::kZ;
  std::int64_t slice_first = 0, row_first = 0, rows = 0, scan_first = 0, scan_voxels = 0;
  std::vector<SliceSpans> slices;
  std::uint64_t voxels = 0;
  std::uint64_t shaded_voxels = 0;  ///< whose colour depends on the view

  /// `row` is a number of the grid; empty outside the box.
  [[nodiscard]] std::span<const Span> row(const SliceSpans& slice, std::int64_t row) const {
    if (slice.spans.empty() || row < row_first || row >= row_first + rows) return {};
    const auto n = static_cast<std::size_t>(row - row_first);
    return std::span(slice.spans).subspan(slice.first_span[n], slice.first_span[n + 1] - slice.first_span[n]);
  }
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

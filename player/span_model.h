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

/// Floats that one vector step may run past a span's end: spans are padded to multiples of it.
inline constexpr std::size_t kSpanPadding = 16;
/// Unselected voxels between two runs that a span includes, as voxels that emit and absorb nothing, because a
/// longer span costs less than a second one.
inline constexpr std::uint32_t kMaxSpanGap = 8;

/// `length` voxels from `start` along a scanline. Their light stands at `offset` in each of the slice's
/// planes, with zeros before and after: plane[offset - 1] and plane[offset + length] up to the padding are 0.
struct Span {
  std::uint32_t start = 0, length = 0;
  std::uint32_t voxels = 0;  ///< those with an extinction; the others are bridged gaps
  std::size_t offset = 0;
};

/// What a voxel emits and absorbs: planes of one float a voxel.
enum class Plane : std::uint8_t { kExtinction = 0, kRed = 1, kGreen = 2, kBlue = 3 };
inline constexpr std::size_t kPlanes = 4;

/// A voxel whose colour depends on the view: it lies on a boundary and is shaded by its normal (hybrid
/// shading).
struct ShadedVoxel {
  std::size_t offset = 0;  ///< in the planes
  PackedNormal normal = 0;
  std::array<float, 3> emission{};  ///< unshaded, 1/mm
};

/// The spans of one slice. Planes hold extinction in 1/mm and emission (colour times extinction) in 1/mm.
struct SliceSpans {
  std::vector<std::uint32_t> first_span;  ///< rows + 1 offsets; empty when the slice has no span
  std::vector<Span> spans;                ///< by row, then start
  std::size_t plane_floats = 0;
  std::unique_ptr<float[]> planes;  ///< kPlanes * plane_floats
  std::vector<ShadedVoxel> shaded;
  std::uint64_t voxels = 0;  ///< selected voxels with an extinction above 0

  [[nodiscard]] const float* plane(Plane p) const {
    return planes.get() + static_cast<std::size_t>(p) * plane_floats;
  }
  [[nodiscard]] float* plane(Plane p) { return planes.get() + static_cast<std::size_t>(p) * plane_floats; }
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

// Spans of the player from any walk over the selected voxels.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "format/tasks/thread_pool.h"
#include "player/render/decode/selected_runs.h"
#include "player/render/sheets/spans/build_spans.h"
#include "player/render/sheets/spans/span_writer.h"
#include "player/render/transfer/volume_appearances.h"

namespace splatlas {

inline constexpr std::uint32_t kNotDrawn = SelectedRuns::kNotDrawn;

/// Adjacent voxels of one scanline with one draw, in grid indices.
struct WalkedRun {
  std::uint32_t row = 0, start = 0, length = 0;
  std::uint32_t draw = 0;  ///< index into the classes of a plan
};

/// A decoded volume and a selection.
struct WalkedScene {
  const Grid& grid;
  const std::byte* values;
  const DrawPlan& plan;
  std::span<const VolumeAppearance> appearances;  ///< per class of the plan
  const ClassTable& classes;
};

/// Per class, the index of the plan entry that draws its volume, or kNotDrawn.
[[nodiscard]] std::vector<std::uint32_t> draws_by_class(const DrawPlan& plan, std::size_t classes);

/// Looks up the voxels of one slice. Adjacent runs with one draw share a look-up.
class WalkedSlice {
 public:
  WalkedSlice(const WalkedScene& scene, Axis axis, std::int64_t slice, int emissions, SliceSpans& out);
  void take(const WalkedRun& run);
  /// Completes the slice. Returns the bounds of its runs: rows in [0], positions along the scanline in [1].
  IndexBox finish();

 private:
  void write();

  const WalkedScene& scene_;
  ScanOrder scan_;
  std::array<std::size_t, 3> step_;
  std::size_t first_;  // voxel of the slice
  SpanWriter writer_;
  WalkedRun whole_;
  IndexBox taken_;
};

/// Crops the model to the bounds of the taken runs, per slice, as in the player. Counts voxels.
void complete(SpanModel& model, std::span<const IndexBox> taken);

/// The spans that the player builds, bit for bit, from `walk(slice, take)`. It calls take(WalkedRun) for the
/// selected runs of a slice of the grid, by row and start. Slices run in parallel.
template <typename Walk>
[[nodiscard]] SpanModel walk_spans(const WalkedScene& scene, Axis axis, ThreadPool& pool, const Walk& walk) {
  SpanModel spans;
  spans.axis = axis;
  set_appearances(scene.plan, scene.appearances, scene.classes, spans);
  spans.slices.resize(static_cast<std::size_t>(scene.grid.size[ScanOrder::of(axis).slice_axis]));
  std::vector<IndexBox> taken(spans.slices.size());
  pool.for_each(spans.slices.size(), [&](std::size_t n) {
    const auto number = static_cast<std::int64_t>(n);
    spans.slices[n].number = number;
    WalkedSlice slice(scene, axis, number, spans.emissions, spans.slices[n]);
    walk(number, [&](const WalkedRun& run) { slice.take(run); });
    taken[n] = slice.finish();
  });
  complete(spans, taken);
  return spans;
}

}  // namespace splatlas

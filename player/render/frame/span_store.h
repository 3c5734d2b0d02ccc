// Spans of the current selection along the three principal axes.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>

#include "player/camera.h"
#include "player/render/frame/draft_pace.h"
#include "player/render/sheets/spans/build_spans.h"
#include "player/render/sheets/spans/coarse_spans.h"
#include "player/render/transfer/shading.h"
#include "player/render/view/shear.h"
#include "player/render_options.h"

namespace splatlas {

/// Memory that `used` bytes leave for spans; an eighth of all at least, as these cannot be less.
[[nodiscard]] std::uint64_t memory_left(std::uint64_t max_memory_bytes, std::uint64_t used);

/// Decoded data of a selection, the input of its spans.
struct SpanSource {
  const DrawPlan& plan;
  const VolumeAppearances& appearances;
  const Selection& selection;  ///< of the plan
  const std::shared_ptr<const Atlas>& atlas;
  const ClassCache& cache;
  bool shade = true;  ///< list lights for hybrid shading
};

/// The volume of a frame by sheets: spans of the voxels, or of downsampled ones.
struct SheetVolume {
  SheetSpans spans;
  Shear shear;  ///< of `grid`
  Grid grid;    ///< of the spans
  VolumeDetail detail;
  std::shared_ptr<const SpanBuilder> held = nullptr;  ///< of this store or another one
};

/// Spans of the current or an earlier selection. Not thread-safe.
struct AxisSpans {
  std::optional<SelectedRuns> runs;  ///< none: of an earlier selection
  std::shared_ptr<SpanBuilder> spans;
  bool has_lights = false;

  /// True if the spans are those of the current selection; with `shade`, also if lights are listed.
  [[nodiscard]] bool current(bool shade) const { return runs && (has_lights || !shade); }
  /// Makes the spans current. Throws std::bad_alloc.
  void require(const SpanSource& source, SelectedRuns selected, ThreadPool& pool);
};

/// Cache of spans by axis: of one, for drafts of two in a quarter of the memory. Keeps the spans of the
/// latest axis after a change of selection, and reuses their unchanged parts. Pictures other than drafts
/// borrow the spans that another store has of the same selection, if any. Not thread-safe.
class SpanStore {
 public:
  /// Prepares the volume of a frame: chooses its detail, and builds spans unless they are current. Blocks
  /// take the place of means of spans that would take long. Spans that may take more than `max_bytes` are
  /// built strip by strip while the frame is drawn; all arguments must outlive it. Sets the traversal and
  /// counters; adds the time to build spans to `select_ms`. Valid until the next call. Throws bad_alloc.
  [[nodiscard]] SheetVolume prepare(const SpanSource& source, const ParallelView& view, const Shear& shear,
                                    const Lighting& lighting, const RenderOptions& options,
                                    std::uint64_t max_bytes, RenderStats& stats, ThreadPool& pool);
  /// Reads blocks of voxels that stand in for the volume of the current selection. False on any error, which
  /// reading the voxels will tell.
  [[nodiscard]] bool require_blocks(const SpanSource& source, ThreadPool& pool);
  /// The same as prepare() for these blocks.
  [[nodiscard]] SheetVolume prepare_blocks(const ParallelView& view, Axis axis, bool shade,
                                           const Lighting& lighting, RenderStats& stats, ThreadPool& pool);
  /// Records the times of the frame of the latest prepare().
  void took(const RenderStats& stats, const RenderOptions& options);
  /// Marks the spans of the latest axis as outdated, and frees the others. For a new plan.
  void outdate();
  /// Frees the spans of other axes than the latest.
  void keep_latest();
  void clear();

  /// Selected runs along an axis; null if its spans are not current.
  [[nodiscard]] const SelectedRuns* runs(Axis axis) const;

 private:
  /// Spans of the voxels for sheets in so many strips.
  [[nodiscard]] SheetSpans in_strips(const SpanSource& source, SelectedRuns runs, std::vector<float> factors,
                                     std::uint64_t strips, ThreadPool& pool);

  std::array<std::optional<AxisSpans>, 3> spans_;
  Axis latest_ = Axis::kZ;
  // Of the current selection
  std::optional<CoarseSpans> means_;
  std::optional<BlockSpans> blocks_;
  std::optional<SelectedRuns> strip_runs_;  // of a frame in strips, or of borrowed spans
  // Of the latest frame, if it was drawn in strips
  SpanModel strip_frame_;
  std::optional<SpanBuilder> strip_;  // of its latest strip
  DraftPace pace_;
};

}  // namespace splatlas

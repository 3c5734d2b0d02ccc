// Span cache of one principal axis.
#pragma once

#include <optional>

#include "player/camera.h"
#include "player/spans/build_spans.h"
#include "player/transfer/shading.h"

namespace splatlas {

/// Spans of the current or an earlier selection, with the lighting of one view. Not thread-safe.
class AxisSpans {
 public:
  /// True if the spans are those of the current selection; with `shade`, also if boundary voxels are listed.
  [[nodiscard]] bool current(bool shade) const { return runs_ && (lists_shaded_ || !shade); }
  /// Marks the spans as those of an earlier selection.
  void outdate() { runs_.reset(); }
  /// Makes the spans current; arguments as for SpanRequest. Throws std::bad_alloc.
  void build(const DrawPlan& plan, const VolumeAppearances& appearances, const Atlas& atlas,
             const ClassCache& cache, Axis axis, bool shade, ThreadPool& pool);
  /// Hybrid shading: applies the lighting of `view` to boundary voxels if it has changed.
  void update_lighting(const ParallelView& view, const Lighting& lighting, bool shade, ThreadPool& pool);

  /// The selected runs, while the spans are current.
  [[nodiscard]] const SelectedRuns& runs() const { return *runs_; }
  [[nodiscard]] const SpanModel& model() const { return spans_.model(); }
  [[nodiscard]] std::uint64_t optical_bytes() const { return spans_.optical_bytes(); }

 private:
  std::optional<SelectedRuns> runs_;
  SpanBuilder spans_;
  bool lists_shaded_ = false;
  std::optional<ParallelView> shaded_for_;  // nullopt if unshaded
  bool partly_shaded_ = false;              // some slices have other shading
};

}  // namespace splatlas

// The spans of one principal axis, from selection to selection and from view to view.
#pragma once

#include <optional>

#include "player/camera.h"
#include "player/spans/build_spans.h"
#include "player/transfer/shading.h"

namespace splatlas {

/// Spans of the current selection or of one before it, and the view whose light they have. Not for use by
/// several threads at once.
class AxisSpans {
 public:
  /// Whether the spans are those of the current selection, boundary voxels listed if they are to be shaded.
  [[nodiscard]] bool current(bool shade) const { return runs_ && (lists_shaded_ || !shade); }
  /// From now on they are those of a selection before.
  void outdate() { runs_.reset(); }
  /// Makes them current; arguments as those of SpanRequest.
  void build(const DrawPlan& plan, const VolumeAppearances& appearances, const Atlas& atlas,
             const ClassCache& cache, Axis axis, bool shade, ThreadPool& pool);
  /// Hybrid shading: the light on boundary voxels changes only with the direction of view.
  void light(const ParallelView& view, const Lighting& lighting, bool shade, ThreadPool& pool);

  /// Only while current.
  [[nodiscard]] const SelectedRuns& runs() const { return *runs_; }
  [[nodiscard]] const SpanModel& model() const { return spans_.model(); }
  [[nodiscard]] std::uint64_t optical_bytes() const { return spans_.optical_bytes(); }

 private:
  std::optional<SelectedRuns> runs_;
  SpanBuilder spans_;
  bool lists_shaded_ = false;
  std::optional<ParallelView> lit_for_;  // none: unshaded
  bool partly_lit_ = false;              // some slices have other light
};

}  // namespace splatlas

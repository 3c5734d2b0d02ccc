// Spans of the current selection along the three principal axes.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "player/camera.h"
#include "player/render/sheets/spans/build_spans.h"
#include "player/render/transfer/shading.h"

namespace splatlas {

/// Upper bound of the memory of spans of this number of voxels.
[[nodiscard]] std::uint64_t max_span_bytes(std::uint64_t voxels, const Atlas& atlas);

/// Spans of the current or an earlier selection, with the lighting of one view. Not thread-safe.
class AxisSpans {
 public:
  /// True if the spans are those of the current selection; with `shade`, also if boundary voxels are listed.
  [[nodiscard]] bool current(bool shade) const { return runs_ && (lists_shaded_ || !shade); }
  /// Marks the spans as those of an earlier selection.
  void outdate() { runs_.reset(); }
  /// Makes the spans current; arguments as for SpanRequest. `shade`: lists boundary voxels. Throws
  /// std::bad_alloc.
  void require(const DrawPlan& plan, const VolumeAppearances& appearances, const Atlas& atlas,
               const ClassCache& cache, Axis axis, bool shade, ThreadPool& pool);
  /// Hybrid shading: applies the lighting of `view` to boundary voxels if it has changed, except to voxels
  /// that the cuts remove.
  void update_lighting(const ParallelView& view, const Lighting& lighting, bool shade, const CutPlanes& cuts,
                       const Grid& grid, ThreadPool& pool);

  /// The selected runs, while the spans are current.
  [[nodiscard]] const SelectedRuns& runs() const { return *runs_; }
  [[nodiscard]] const SpanModel& model() const { return spans_.model(); }
  [[nodiscard]] std::uint64_t optical_bytes() const { return spans_.optical_bytes(); }

 private:
  std::optional<SelectedRuns> runs_;
  SpanBuilder spans_;
  bool lists_shaded_ = false;
  std::optional<ParallelView> shaded_for_;  // nullopt if unshaded
  CutPlanes shaded_cuts_;                   // voxels that these remove have other shading
  bool partly_shaded_ = false;              // some slices have other shading
};

/// Cache of spans by axis. Keeps the spans of the latest axis after a change of selection, and reuses their
/// unchanged parts. Not thread-safe.
class SpanStore {
 public:
  /// Spans along an axis, which becomes the latest: current, outdated or none.
  [[nodiscard]] AxisSpans& along(Axis axis);
  /// Marks the spans of the latest axis as outdated, and frees the others. For a new plan.
  void outdate();
  /// Frees outdated spans that take more than `bytes`.
  void make_room(std::uint64_t bytes);
  void clear();

  /// Selected runs along an axis; null if its spans are not current.
  [[nodiscard]] const SelectedRuns* runs(Axis axis) const;

 private:
  std::array<std::optional<AxisSpans>, 3> spans_;
  Axis latest_ = Axis::kZ;
};

}  // namespace splatlas

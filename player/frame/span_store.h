// Spans of the current selection along the three principal axes.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "player/spans/axis_spans.h"

namespace splatlas {

/// Builds spans once per selection and axis. Spans of the axis in use outlive a change of selection, so that
/// what stays selected is not built again.
class SpanStore {
 public:
  /// The spans of the plan along an axis; `shade`: with boundary voxels listed.
  [[nodiscard]] AxisSpans& require(const DrawPlan& plan, const VolumeAppearances& appearances,
                                   const Atlas& atlas, const ClassCache& cache, Axis axis, bool shade,
                                   ThreadPool& pool);
  /// Call when the plan changes. Keeps the spans of the latest axis as those of an earlier selection.
  void outdate();
  /// Frees spans of earlier selections that take more than `bytes`.
  void make_room(std::uint64_t bytes);
  void clear();

  /// Selected runs along an axis; null when its spans are not current.
  [[nodiscard]] const SelectedRuns* runs(Axis axis) const;

 private:
  std::array<std::optional<AxisSpans>, 3> spans_;
  Axis latest_ = Axis::kZ;
};

}  // namespace splatlas

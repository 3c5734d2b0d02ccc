// Spans of the current selection along the three principal axes.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "player/spans/axis_spans.h"

namespace splatlas {

/// Cache of spans by axis. Keeps the spans of the latest axis after a change of selection, and reuses their
/// unchanged parts. Not thread-safe.
class SpanStore {
 public:
  /// Spans of the plan along an axis, built if they are not current. `shade`: lists boundary voxels.
  [[nodiscard]] AxisSpans& require(const DrawPlan& plan, const VolumeAppearances& appearances,
                                   const Atlas& atlas, const ClassCache& cache, Axis axis, bool shade,
                                   ThreadPool& pool);
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

// A selection, the plan that draws it, and the appearances of the plan's classes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "format/decision_tree.h"
#include "format/selection.h"
#include "player/spans/class_cache.h"
#include "player/surfaces/rasterize.h"
#include "player/transfer/volume_appearances.h"

namespace splatlas {

class DrawnSelection {
 public:
  explicit DrawnSelection(const Atlas& atlas) : appearances_(atlas) {}

  /// Replaces the selection; draw() follows. `max_span_bytes`: memory that its spans may take.
  void select(const Selection& selection, std::uint64_t max_span_bytes);
  /// Draws this plan of the selection. Nothing is drawn when memory runs out (std::bad_alloc).
  void draw(DrawPlan plan);
  /// Draws nothing.
  void clear() { plan_ = {}; }

  [[nodiscard]] const Selection& selection() const { return selection_; }
  [[nodiscard]] const DrawPlan& plan() const { return plan_; }
  [[nodiscard]] const VolumeAppearances& appearances() const { return appearances_; }
  [[nodiscard]] std::uint64_t max_span_bytes() const { return max_span_bytes_; }
  [[nodiscard]] bool draws_nothing() const;

  /// The plan's surfaces, which have been decoded.
  [[nodiscard]] std::vector<SurfaceDraw> surfaces(const ClassCache& cache) const;

 private:
  Selection selection_;
  DrawPlan plan_;
  VolumeAppearances appearances_;  // of plan_.classes
  std::uint64_t max_span_bytes_ = 0;
};

}  // namespace splatlas

#include "player/frame/drawn_selection.h"

#include <new>
#include <utility>

namespace splatlas {

void DrawnSelection::select(const Selection& selection, std::uint64_t max_span_bytes) {
  selection_ = selection;
  max_span_bytes_ = max_span_bytes;
}

void DrawnSelection::draw(DrawPlan plan) {
  plan_ = std::move(plan);
  try {
    appearances_.select(plan_, selection_);
  } catch (const std::bad_alloc&) {
    clear();
    throw;
  }
}

void DrawnSelection::clear() {
  plan_ = {};
  appearances_.clear();
}

bool DrawnSelection::draws_nothing() const {
  return volume_classes(plan_).empty() && plan_.surfaces.empty();
}

std::vector<SurfaceDraw> DrawnSelection::surfaces(const ClassCache& cache) const {
  std::vector<SurfaceDraw> draws;
  for (const StructureIndex s : plan_.surfaces) {
    draws.push_back(surface_draw(s, selection_.structures[s], cache.surface(s)));
  }
  return draws;
}

}  // namespace splatlas

#include "player/frame/span_store.h"

#include <utility>
#include <vector>

namespace splatlas {

void AxisSpans::require(const DrawPlan& plan, const VolumeAppearances& appearances, const Atlas& atlas,
                        const ClassCache& cache, Axis axis, bool shade, ThreadPool& pool) {
  if (current(shade)) return;
  // If an allocation throws, no incomplete spans remain marked as current.
  runs_.reset();
  SpanBuilder spans = std::exchange(spans_, {});
  SelectedRuns runs(plan, atlas.classes(), cache, axis);
  spans.build({runs, plan, appearances, atlas.classes(), atlas.grid(), cache, shade}, pool);
  spans_ = std::move(spans);
  runs_.emplace(std::move(runs));
  lists_shaded_ = shade;
  partly_shaded_ = partly_shaded_ || shaded_for_.has_value();
}

void AxisSpans::update_lighting(const ParallelView& view, const Lighting& lighting, bool shade,
                                ThreadPool& pool) {
  const bool same_view = shaded_for_ && have_same_lighting(*shaded_for_, view);
  if (!partly_shaded_ && (shade ? same_view : !shaded_for_)) return;
  if (model().shaded_voxels > 0) {
    const std::vector<float> factors = shade ? lighting.table() : std::vector<float>(65536, 1.0f);
    partly_shaded_ = true;  // in case the task is cancelled
    shade_spans(spans_.model(), factors, pool);
  }
  shaded_for_ = shade ? std::optional(view) : std::nullopt;
  partly_shaded_ = false;
}

AxisSpans& SpanStore::along(Axis axis) {
  latest_ = axis;
  std::optional<AxisSpans>& spans = spans_[static_cast<std::size_t>(axis)];
  return spans ? *spans : spans.emplace();
}

void SpanStore::outdate() {
  for (const Axis axis : kAxes) {
    std::optional<AxisSpans>& spans = spans_[static_cast<std::size_t>(axis)];
    if (!spans) continue;
    if (axis == latest_) {
      spans->outdate();
    } else {
      spans.reset();
    }
  }
}

void SpanStore::make_room(std::uint64_t bytes) {
  for (std::optional<AxisSpans>& spans : spans_) {
    if (spans && !spans->current(false) && spans->optical_bytes() > bytes) spans.reset();
  }
}

void SpanStore::clear() {
  for (std::optional<AxisSpans>& spans : spans_) spans.reset();
}

const SelectedRuns* SpanStore::runs(Axis axis) const {
  const std::optional<AxisSpans>& spans = spans_[static_cast<std::size_t>(axis)];
  return spans && spans->current(false) ? &spans->runs() : nullptr;
}

}  // namespace splatlas

#include "player/frame/span_store.h"

namespace splatlas {

AxisSpans& SpanStore::require(const DrawPlan& plan, const VolumeAppearances& appearances, const Atlas& atlas,
                              const ClassCache& cache, Axis axis, bool shade, ThreadPool& pool) {
  latest_ = axis;
  std::optional<AxisSpans>& spans = spans_[static_cast<std::size_t>(axis)];
  if (!spans) spans.emplace();
  if (!spans->current(shade)) spans->build(plan, appearances, atlas, cache, axis, shade, pool);
  return *spans;
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

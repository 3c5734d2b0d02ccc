#include "player/spans/axis_spans.h"

#include <utility>
#include <vector>

namespace splatlas {

void AxisSpans::build(const DrawPlan& plan, const VolumeAppearances& appearances, const Atlas& atlas,
                      const ClassCache& cache, Axis axis, bool shade, ThreadPool& pool) {
  // Where memory runs out on the way, nothing is left that could be taken for finished.
  runs_.reset();
  SpanBuilder spans = std::exchange(spans_, {});
  SelectedRuns runs(plan, atlas.classes(), cache, axis);
  spans.build({runs, plan, appearances, atlas.classes(), atlas.grid(), cache, shade}, pool);
  spans_ = std::move(spans);
  runs_.emplace(std::move(runs));
  lists_shaded_ = shade;
  partly_lit_ = partly_lit_ || lit_for_.has_value();
}

void AxisSpans::light(const ParallelView& view, const Lighting& lighting, bool shade, ThreadPool& pool) {
  const bool same_view = lit_for_ && have_same_light(*lit_for_, view);
  if (!partly_lit_ && (shade ? same_view : !lit_for_)) return;
  if (model().shaded_voxels > 0) {
    const std::vector<float> light = shade ? lighting.table() : std::vector<float>(65536, 1.0f);
    partly_lit_ = true;  // if the task is cancelled on the way
    shade_spans(spans_.model(), light, pool);
  }
  lit_for_ = shade ? std::optional(view) : std::nullopt;
  partly_lit_ = false;
}

}  // namespace splatlas

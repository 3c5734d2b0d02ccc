#include "player/render/frame/span_store.h"

#include <algorithm>
#include <cstddef>
#include <mutex>
#include <tuple>
#include <utility>
#include <vector>

#include "format/tasks/task_control.h"
#include "player/render/frame/stopwatch.h"

namespace splatlas {
namespace {

/// Time to build spans, per voxel and thread, and the longest that a draft waits if there are blocks.
constexpr double kBuildMsPerVoxel = 40e-6, kMaxBuildMs = 130;

/// Voxels of a volume with means in the file.
double stored_means(const SpanSource& source) {
  double voxels = 0;
  for (const ClassId c : volume_classes(source.plan)) {
    if (source.atlas->has_means(c)) voxels += static_cast<double>(source.atlas->classes().voxels(c));
  }
  return voxels;
}

/// Identifies spans: atlas, axis, whether they have lights, selection, and the classes left in the draw plan.
using SpanKey = std::tuple<const Atlas*, Axis, bool, Selection, std::vector<ClassDraw>>;
SpanKey key_of(const SpanSource& source, Axis axis) {
  return {source.atlas.get(), axis, source.shade, source.selection, source.plan.classes};
}

std::recursive_mutex known_mutex;  // a pointer that cannot be made is released at once
std::vector<std::pair<SpanKey, std::weak_ptr<SpanBuilder>>> known_spans;

/// Spans of another store than `own`, which does not change them as long as they are held; or null.
std::shared_ptr<const SpanBuilder> borrow(const SpanKey& key, const std::optional<AxisSpans>& own) {
  const std::lock_guard lock(known_mutex);
  for (const auto& [of, spans] : known_spans) {
    auto found = spans.lock();
    if (found && (!own || own->spans != found) && of == key)
      return {found.get(), [found](const SpanBuilder* /*spans*/) mutable {
                const std::lock_guard end(known_mutex);
                found.reset();
              }};
  }
  return nullptr;
}

}  // namespace

std::uint64_t memory_left(std::uint64_t max_memory_bytes, std::uint64_t used) {
  const auto all = static_cast<std::uint64_t>(std::min(max_memory(), static_cast<double>(max_memory_bytes)));
  return std::max(all - std::min(used, all), all / 8);
}

void AxisSpans::require(const SpanSource& source, SelectedRuns selected, ThreadPool& pool) {
  const auto& [plan, appearances, selection, atlas, cache, shade] = source;
  if (current(shade)) return;
  // If an allocation throws, no incomplete spans remain
  runs.reset();
  std::shared_ptr<SpanBuilder> built = std::exchange(spans, nullptr);
  {
    const std::lock_guard lock(known_mutex);
    std::erase_if(known_spans, [&](auto& of) { return of.second.expired() || of.second.lock() == built; });
    if (!built || built.use_count() > 1) built = std::make_shared<SpanBuilder>();
  }
  built->build({selected, plan, appearances, atlas->classes(), atlas->grid(), cache, shade}, pool);
  spans = std::move(built);
  runs.emplace(std::move(selected));
  has_lights = shade;
  const std::lock_guard lock(known_mutex);
  known_spans.emplace_back(key_of(source, spans->model().axis), spans);
}

SheetVolume SpanStore::prepare(const SpanSource& source, const ParallelView& view, const Shear& shear,
                               const Lighting& lighting, const RenderOptions& options,
                               std::uint64_t max_bytes, RenderStats& stats, ThreadPool& pool) {
  const auto& [plan, appearances, selection, atlas, cache, shade] = source;
  const Axis axis = shear.principal;
  Stopwatch watch;
  SelectedRuns runs(plan, atlas->classes(), cache, axis);
  stats.runs_visited = runs.count();

  const std::uint64_t voxels = plan.volume_voxels + plan.hybrid_voxels;
  const std::uint64_t bytes = span_model_bytes(voxels, std::min(runs.count(), voxels));
  // Keep one axis; for drafts, which follow the pointer to and fro, two in a quarter of the memory
  const bool keeps_two = options.quality == Quality::kDraft && 8 * bytes <= max_bytes;
  for (const Axis other : kAxes) {
    const bool is_kept = other == axis || (keeps_two && (axis == latest_ || other == latest_));
    if (!is_kept || bytes > max_bytes) spans_[static_cast<std::size_t>(other)].reset();
  }
  std::optional<AxisSpans>& spans = spans_[static_cast<std::size_t>(axis)];

  // Choose the detail
  const bool fits = bytes <= max_bytes;
  const bool is_ready = fits && ((spans && spans->current(shade)) ||
                                 stored_means(source) * kBuildMsPerVoxel / pool.threads() <= kMaxBuildMs);
  VolumeDetail detail = may_be_rough(options) ? pace_.next(shear.voxel_pixels(), is_ready) : VolumeDetail{};
  const bool has_means = means_ && means_->fit(axis, detail.level, shade);
  if (detail.level > 0 && !has_means && !is_ready) {
    if (require_blocks(source, pool)) return prepare_blocks(view, axis, shade, lighting, stats, pool);
    detail = {};
  }
  stats.level = detail.level;
  stats.strips = detail.level == 0 && !fits;
  const auto volume_of = [&](SheetSpans spans, const Shear& of_spans, const Grid& grid,
                             const std::shared_ptr<const SpanBuilder>& held = nullptr) -> SheetVolume {
    stats.traversal = watch.lap();
    stats.select_ms += stats.traversal.wall_ms;
    return {std::move(spans), of_spans, grid, detail, held};
  };
  std::vector<float> factors = shade ? lighting.table() : std::vector<float>();
  if (!stats.strips) blocks_.reset();
  if (detail.level > 0) {
    if (!has_means) {
      means_.reset();
      if (!spans) spans.emplace();
      spans->require(source, std::move(runs), pool);
      latest_ = axis;
      means_.emplace(spans->spans->model(), shade, detail.level, pool);
    }
    const Grid of_means = coarse_grid(atlas->grid(), detail.level);
    return volume_of(SheetSpans(means_->model(), std::move(factors)), factorise(view, of_means, &axis),
                     of_means);
  }
  latest_ = axis;
  if (stats.strips) {
    const std::uint64_t strips = bytes / std::max<std::uint64_t>(max_bytes, 1) + 1;
    return {in_strips(source, std::move(runs), std::move(factors), strips, pool), shear, atlas->grid(),
            detail};
  }
  strip_.reset();
  std::shared_ptr<const SpanBuilder> held;
  const bool has_own = spans && spans->current(shade);
  if (options.quality != Quality::kDraft && !has_own) held = borrow(key_of(source, axis), spans);
  if (held) {
    spans.reset();
    strip_runs_.emplace(std::move(runs));
  } else {
    if (!spans) spans.emplace();
    spans->require(source, std::move(runs), pool);
    held = spans->spans;
  }
  return volume_of(SheetSpans(held->model(), std::move(factors)), shear, atlas->grid(), held);
}

SheetSpans SpanStore::in_strips(const SpanSource& source, SelectedRuns runs, std::vector<float> factors,
                                std::uint64_t strips, ThreadPool& pool) {
  const SelectedRuns& of_frame = strip_runs_.emplace(std::move(runs));
  const SpanRequest request{
      of_frame,     source.plan, source.appearances, source.atlas->classes(), source.atlas->grid(),
      source.cache, source.shade};
  strip_frame_ = empty_model(request);
  strip_frame_.voxels = source.plan.volume_voxels + source.plan.hybrid_voxels;
  return SheetSpans(strip_frame_, std::move(factors), static_cast<std::size_t>(strips),
                    [this, request, &pool](const SheetStrip& strip) -> const SpanModel& {
                      SpanRequest of_strip = request;
                      of_strip.strip.emplace(strip);
                      strip_.emplace().build(of_strip, pool);
                      return strip_->model();
                    });
}

bool SpanStore::require_blocks(const SpanSource& source, ThreadPool& pool) {
  if (blocks_) return true;
  Result<std::unique_ptr<BlockVolume>> volume = BlockVolume::read(source.atlas, source.plan, pool);
  if (!volume) return false;
  blocks_.emplace(*std::move(volume), source.selection, *source.atlas);
  return true;
}

SheetVolume SpanStore::prepare_blocks(const ParallelView& view, Axis axis, bool shade,
                                      const Lighting& lighting, RenderStats& stats, ThreadPool& pool) {
  Stopwatch watch;
  blocks_->prepare(axis, shade, pool);
  stats.traversal = watch.lap();
  stats.select_ms += stats.traversal.wall_ms;
  stats.level = kMeanLevel;
  stats.strips = false;
  const Grid& grid = blocks_->grid();
  return {SheetSpans(blocks_->model(), shade ? lighting.table() : std::vector<float>()),
          factorise(view, grid, &axis),
          grid,
          {kMeanLevel, 1}};
}

void SpanStore::took(const RenderStats& stats, const RenderOptions& options) {
  if (!blocks_) pace_.took(stats, options);
}

void SpanStore::outdate() {
  means_.reset();
  blocks_.reset();
  strip_.reset();
  strip_runs_.reset();
  keep_latest();
  if (auto& spans = spans_[static_cast<std::size_t>(latest_)]) spans->runs.reset();
}

void SpanStore::keep_latest() {
  for (const Axis axis : kAxes) {
    if (axis != latest_) spans_[static_cast<std::size_t>(axis)].reset();
  }
}

void SpanStore::clear() {
  outdate();
  for (std::optional<AxisSpans>& spans : spans_) spans.reset();
}

const SelectedRuns* SpanStore::runs(Axis axis) const {
  if (strip_runs_ && strip_runs_->axis() == axis) return &*strip_runs_;
  const std::optional<AxisSpans>& spans = spans_[static_cast<std::size_t>(axis)];
  return spans && spans->current(false) ? &*spans->runs : nullptr;
}

}  // namespace splatlas

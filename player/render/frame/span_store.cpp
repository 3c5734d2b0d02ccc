#include "player/render/frame/span_store.h"

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "format/tasks/task_control.h"
#include "player/render/clip/cut_rays.h"
#include "player/render/frame/stopwatch.h"
#include "player/render/light/voxel_light.h"
#include "player/render/sheets/splat/block_runs.h"

namespace splatlas {
namespace {

/// Distance from a cut's kept part, in voxels, up to which voxels can contribute to a slab's kept part.
constexpr double kReach = 4;

/// Voxels [first, last) of a row whose lighting a cut may show.
Blocks kept_voxels(const SpanModel& model, std::span<const VoxelPlane> planes, std::int64_t slice,
                   std::int64_t row) {
  const ClipDepths kept =
      kept_scan(planes, ScanOrder::of(model.axis), slice, row, [](const VoxelPlane&) { return kReach; });
  const double first = std::max(0.0, kept.from);
  const double last = std::min(static_cast<double>(model.scan_first + model.scan_voxels), kept.to);
  if (!(first < last)) return {0, 0};
  return {static_cast<std::int64_t>(first), static_cast<std::int64_t>(last) + 1};
}

/// Blocks [first, last) of the slice that hold these voxels of a row.
std::pair<std::uint32_t, std::uint32_t> blocks_of(const SliceSpans& slice, std::int64_t row,
                                                  const Blocks& voxels) {
  std::pair<std::uint32_t, std::uint32_t> blocks{0, 0};
  for (const Span& span : slice.row(row)) {
    const std::int64_t begin = std::max<std::int64_t>(voxels.first >> kBlockBits, span.first_block);
    const std::int64_t end =
        std::min((voxels.last + kBlock - 1) >> kBlockBits, std::int64_t{span.first_block} + span.blocks);
    if (begin >= end) continue;
    const auto of_slice = [&](std::int64_t block) {
      return span.offset + static_cast<std::uint32_t>(block - span.first_block);
    };
    if (blocks.first == blocks.second) blocks.first = of_slice(begin);
    blocks.second = of_slice(end);
  }
  return blocks;
}

/// light_spans() for the voxels that a cut may show, of the slices that are not lit.
void light_kept_spans(SpanModel& model, std::span<const float> factors, std::span<const VoxelPlane> planes,
                      ThreadPool& pool) {
  const LightKernels kernels = light_kernels();
  pool.for_each(model.slices.size(), [&](std::size_t n) {
    SliceSpans& slice = model.slices[n];
    if (slice.is_lit) return;
    const LitBlock* block = slice.lit.data();
    const LitBlock* const all = block + slice.lit.size();
    for (std::int64_t row = slice.first_row; row < slice.last_row; ++row) {
      const auto [first, last] = blocks_of(slice, row, kept_voxels(model, planes, slice.number, row));
      block = std::ranges::lower_bound(block, all, first, {}, &LitBlock::block);
      const LitBlock* const end = std::ranges::lower_bound(block, all, last, {}, &LitBlock::block);
      kernels.emit({block, static_cast<std::size_t>(end - block)}, factors.data(), slice.emissions,
                   slice.optics.data());
      block = end;
    }
    slice.is_lit = true;
  });
}

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

}  // namespace

std::uint64_t memory_left(std::uint64_t max_memory_bytes, std::uint64_t used) {
  const auto all = static_cast<std::uint64_t>(std::min(max_memory(), static_cast<double>(max_memory_bytes)));
  return std::max(all - std::min(used, all), all / 8);
}

void AxisSpans::require(const SpanSource& source, SelectedRuns runs, const ParallelView* view,
                        const Lighting& lighting, ThreadPool& pool) {
  const auto& [plan, appearances, selection, atlas, cache, shade] = source;
  if (current(shade)) return;
  // If an allocation throws, no incomplete spans remain marked as current.
  runs_.reset();
  SpanBuilder spans = std::exchange(spans_, {});
  std::vector<float> factors;
  if (shade && view != nullptr) {
    if (!shaded_for_ || !have_same_lighting(*shaded_for_, *view) || !shaded_cuts_.empty())
      forget_light(spans.model());
    factors = lighting.table();
    shaded_for_ = *view;
    shaded_cuts_ = {};
  }
  spans.build({runs, plan, appearances, atlas->classes(), atlas->grid(), cache, shade, {}, factors}, pool);
  spans_ = std::move(spans);
  runs_.emplace(std::move(runs));
  lists_shaded_ = shade;
  const auto is_unlit = [](const SliceSpans& slice) { return !slice.is_lit && !slice.lit.empty(); };
  partly_shaded_ =
      factors.empty() ? partly_shaded_ || shaded_for_ : std::ranges::any_of(model().slices, is_unlit);
}

void AxisSpans::update_lighting(const ParallelView& view, const Lighting& lighting, bool shade,
                                const CutPlanes& cuts, const Grid& grid, ThreadPool& pool) {
  const bool same_cuts = shaded_cuts_.empty() || shaded_cuts_ == cuts;
  const bool same_view = shaded_for_ && have_same_lighting(*shaded_for_, view) && same_cuts;
  if (!partly_shaded_ && (shade ? same_view : !shaded_for_)) return;
  if (model().lit_blocks > 0) {
    const std::vector<float> factors = shade ? lighting.table() : std::vector<float>(65536, 1.0f);
    partly_shaded_ = true;  // in case the task is cancelled
    if (!shade || !same_view) {
      shaded_for_.reset();
      forget_light(spans_.model());
    }
    if (shade && !cuts.empty()) {
      light_kept_spans(spans_.model(), factors, voxel_planes(cuts, grid), pool);
    } else {
      light_spans(spans_.model(), factors, pool);
    }
  }
  shaded_for_ = shade ? std::optional(view) : std::nullopt;
  shaded_cuts_ = shade ? cuts : CutPlanes{};
  partly_shaded_ = false;
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
  make_room(axis, bytes, max_bytes);
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
  const auto built = [&] {
    stats.traversal = watch.lap();
    stats.select_ms += stats.traversal.wall_ms;
  };
  if (!stats.strips) blocks_.reset();
  if (detail.level > 0) {
    if (!has_means) {
      means_.reset();
      if (!spans) spans.emplace();
      spans->require(source, std::move(runs), nullptr, lighting, pool);
      latest_ = axis;
      means_.emplace(spans->model(), shade, detail.level, pool);
    }
    built();
    means_->light(view, lighting, pool);
    stats.traversal += watch.lap();
    const Grid of_means = coarse_grid(atlas->grid(), detail.level);
    return {SheetSpans(means_->model()), factorise(view, of_means, &axis), of_means, detail};
  }
  latest_ = axis;
  if (stats.strips) {
    const std::uint64_t strips = bytes / std::max<std::uint64_t>(max_bytes, 1) + 1;
    return {in_strips(source, std::move(runs), lighting, strips, pool), shear, atlas->grid(), detail};
  }
  strip_.reset();
  if (!spans) spans.emplace();
  spans->require(source, std::move(runs), options.cuts.empty() ? &view : nullptr, lighting, pool);
  built();
  spans->update_lighting(view, lighting, shade, options.cuts, atlas->grid(), pool);
  stats.traversal += watch.lap();
  return {SheetSpans(spans->model()), shear, atlas->grid(), detail};
}

SheetSpans SpanStore::in_strips(const SpanSource& source, SelectedRuns runs, const Lighting& lighting,
                                std::uint64_t strips, ThreadPool& pool) {
  const SelectedRuns& of_frame = strip_runs_.emplace(std::move(runs));
  const SpanRequest request{
      of_frame,     source.plan, source.appearances, source.atlas->classes(), source.atlas->grid(),
      source.cache, source.shade};
  strip_frame_ = empty_model(request);
  strip_frame_.voxels = source.plan.volume_voxels + source.plan.hybrid_voxels;
  return {strip_frame_, static_cast<std::size_t>(strips),
          [this, request, &lighting, &pool](const SheetStrip& strip) -> const SpanModel& {
            SpanRequest of_strip = request;
            of_strip.strip.emplace(strip);
            const std::vector<float> factors = lighting.table();
            if (request.shade) of_strip.factors = factors;
            strip_.emplace().build(of_strip, pool);
            return strip_->model();
          }};
}

void SpanStore::make_room(Axis axis, std::uint64_t bytes, std::uint64_t max_bytes) {
  auto axes = static_cast<std::uint64_t>(
      std::ranges::count_if(spans_, [](const auto& each) { return each.has_value(); }));
  if (!spans_[static_cast<std::size_t>(axis)]) ++axes;
  if (axes * bytes <= max_bytes) return;
  for (const Axis other : kAxes) {
    if (other != axis || bytes > max_bytes) spans_[static_cast<std::size_t>(other)].reset();
  }
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
  blocks_->prepare(axis, shade, view, lighting, pool);
  stats.traversal = watch.lap();
  stats.select_ms += stats.traversal.wall_ms;
  stats.level = kMeanLevel;
  stats.strips = false;
  const Grid& grid = blocks_->grid();
  return {SheetSpans(blocks_->model()), factorise(view, grid, &axis), grid, {kMeanLevel, 1}};
}

void SpanStore::took(const RenderStats& stats, const RenderOptions& options) {
  if (!blocks_) pace_.took(stats, options);
}

void SpanStore::outdate() {
  means_.reset();
  blocks_.reset();
  strip_.reset();
  strip_runs_.reset();
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

void SpanStore::clear() {
  outdate();
  for (std::optional<AxisSpans>& spans : spans_) spans.reset();
}

const SelectedRuns* SpanStore::runs(Axis axis) const {
  if (strip_runs_ && strip_runs_->axis() == axis) return &*strip_runs_;
  const std::optional<AxisSpans>& spans = spans_[static_cast<std::size_t>(axis)];
  return spans && spans->current(false) ? &spans->runs() : nullptr;
}

}  // namespace splatlas

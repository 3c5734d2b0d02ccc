#include "bench/limit_task.h"

#include <limits>
#include <utility>

#include "bench/frames.h"
#include "format/system/result_macros.h"

namespace splatlas {

LimitTask::LimitTask(std::shared_ptr<const Atlas> atlas, ErrorModel model, int size, int frames)
    : atlas_(std::move(atlas)), model_(std::move(model)), frames_(frames) {
  options_.size = {size, size};
  options_.hybrid_shading = false;
  options_.termination_threshold = 0.0f;
}

Result<LimitTask::Frame> LimitTask::frame_of(int turn) const {
  SPLATLAS_ASSIGN_OR_RETURN(const ParallelView view, parallel_view(turned(model_.camera, turn, frames_),
                                                                   options_.size, atlas_->display()));
  return Frame{view, factorise(view, atlas_->grid())};
}

Result<void> LimitTask::prepare(int turns) {
  for (int turn = 0; turn < turns; ++turn) {
    SPLATLAS_ASSIGN_OR_RETURN(const Frame frame, frame_of(turn));
    if (axes_.contains(frame.shear.principal)) continue;
    SPLATLAS_ASSIGN_OR_RETURN(const DecodedVolumes decoded,
                              decode_volumes(atlas_, model_.selection, frame.shear.principal, pool_));
    AxisModels& models = axes_[frame.shear.principal];
    models.builder.build({*decoded.runs, decoded.plan, *decoded.appearances, atlas_->classes(),
                          atlas_->grid(), *decoded.cache, false},
                         pool_);
    SPLATLAS_RETURN_IF_ERROR(draw(turn));
    const SheetWindow& window = buffers_.sheet.window;
    models.packed = pack_spans(models.spans(), frame.shear, window);
    const auto per_slice = static_cast<std::uint64_t>(window.columns * window.rows);
    models.dense = DenseVolume::fog(
        window.columns, window.rows,
        static_cast<std::int64_t>(
            (models.spans().voxels * static_cast<std::uint64_t>(parts()) + per_slice - 1) / per_slice),
        planes());
    SPLATLAS_RETURN_IF_ERROR(draw_packed(turn));
    SPLATLAS_RETURN_IF_ERROR(draw_dense(turn));
  }
  return {};
}

Result<std::vector<Elapsed>> LimitTask::draw(int turn) {
  SPLATLAS_ASSIGN_OR_RETURN(const Frame frame, frame_of(turn));
  const Lighting lighting(frame.view);
  Stopwatch watch;
  SPLATLAS_ASSIGN_OR_RETURN(const FrameCounters drawn,
                            draw_frame({.spans = axes_.at(frame.shear.principal).spans(),
                                        .surfaces = {},
                                        .view = frame.view,
                                        .shear = frame.shear,
                                        .grid = atlas_->grid(),
                                        .lighting = lighting,
                                        .options = options_,
                                        .max_memory_bytes = std::numeric_limits<std::uint64_t>::max()},
                                       buffers_, picture_, pool_));
  const Elapsed elapsed = watch.lap();
  if (drawn.voxels != axes_.at(frame.shear.principal).spans().voxels) {
    return fail(ErrorCode::kFailed, "a part of the scene lies outside of the picture");
  }
  return std::vector{elapsed, drawn.rasterize, drawn.sheets, drawn.resolve};
}

Result<std::vector<Elapsed>> LimitTask::draw_packed(int turn) {
  SPLATLAS_ASSIGN_OR_RETURN(const Frame frame, frame_of(turn));
  const PackedSpans& packed = axes_.at(frame.shear.principal).packed;
  FragmentList none;
  none.first_of_row.assign(static_cast<std::size_t>(options_.size.height) + 1, 0);
  Stopwatch watch;
  no_fragments_.build(none, packed.shear, packed.window, options_.size, atlas_->grid(), pool_);
  const SheetCounters counters = render_sheets(packed.model, packed.shear, packed.window, best_kernels(), 0,
                                               no_fragments_, packed_sheet_, pool_);
  const Elapsed elapsed = watch.lap();
  if (counters.voxels != packed.model.voxels) {
    return fail(ErrorCode::kFailed, "a part of the packed voxels lies outside of the sheet");
  }
  return std::vector{elapsed};
}

Result<std::vector<Elapsed>> LimitTask::draw_dense(int turn) {
  SPLATLAS_ASSIGN_OR_RETURN(const Frame frame, frame_of(turn));
  dense_sheet_.scale = scale();
  Stopwatch watch;
  composite_dense(axes_.at(frame.shear.principal).dense, dense_sheet_);
  return std::vector{watch.lap()};
}

std::uint64_t LimitTask::scene_samples() const {
  return axes_.begin()->second.spans().voxels * static_cast<std::uint64_t>(scale() * scale() * parts());
}

double LimitTask::fill() const {
  const SpanModel& model = axes_.begin()->second.spans();
  std::uint64_t blocks = 0;
  for (const SliceSpans& slice : model.slices) {
    for (const Span& span : slice.spans) blocks += span.blocks;
  }
  return static_cast<double>(model.voxels) / static_cast<double>(blocks << kBlockBits);
}

Result<std::uint64_t> LimitTask::dense_samples(int turn) const {
  SPLATLAS_ASSIGN_OR_RETURN(const Frame frame, frame_of(turn));
  return samples(axes_.at(frame.shear.principal).dense, scale());
}

}  // namespace splatlas

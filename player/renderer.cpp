#include "player/renderer.h"

#include <utility>

#include "format/io/memory_limit.h"
#include "format/result_macros.h"
#include "format/tasks/task_control.h"
#include "format/tasks/thread_pool.h"
#include "player/render/contributions/pick_structure.h"
#include "player/render/frame/decoded_selection.h"
#include "player/render/frame/drawn_selection.h"
#include "player/render/frame/fit_selection.h"
#include "player/render/frame/frame_renderer.h"
#include "player/render/frame/ray_frame.h"
#include "player/render/frame/sheet_frame.h"
#include "player/render/frame/span_store.h"
#include "player/render/frame/stopwatch.h"

namespace splatlas {
namespace {

struct FrameCall {
  const View& view;
  const RenderOptions& options;
  const RenderOverrides& overrides;
  TaskControl& task;
};

/// Progress of a frame after decoding, and number of loops that draw its volume.
constexpr double kDecoded = 0.2, kPrepared = 0.3;
constexpr int kMaxFitSteps = 30;  // 4 to 16 as a rule; more for deep content in wide fields of view
constexpr std::size_t kSheetLoops = 4, kRayLoops = 1;

}  // namespace

struct Renderer::Impl {
  Impl(std::shared_ptr<const Atlas> opened, const RendererOptions& options)
      : atlas(std::move(opened)),
        pool(options.threads),
        max_memory_bytes(options.max_memory_bytes > 0 ? options.max_memory_bytes : default_memory_limit()),
        drawn(*atlas),
        decoded(atlas) {}

  [[nodiscard]] Result<void> select(const Selection& selection) {
    Stopwatch watch;
    SPLATLAS_RETURN_IF_ERROR(check_selection(selection, atlas->graph()));
    DrawPlan plan = atlas->tree().plan(selection);
    drawn.select(selection);
    if (decoded.begin(plan, max_memory_bytes / 2) || volume_classes(plan).empty()) spans.clear();
    stats = {};
    fit_decode_ms = 0;
    draw(std::move(plan));
    stats.select_ms = watch.lap().wall_ms;
    return {};
  }

  /// Replaces the draw plan and drops all data of the previous one.
  void draw(DrawPlan plan) {
    spans.outdate();  // first: out of memory in draw() leaves an empty plan
    rays.clear();
    faces.clear();
    forget_frames();
    drawn.draw(std::move(plan));
    const DrawPlan& now = drawn.plan();
    stats.volume_voxels = now.volume_voxels;
    stats.surface_voxels = now.surface_voxels;
    stats.hybrid_voxels = now.hybrid_voxels;
    stats.occupancy = static_cast<double>(now.volume_voxels + now.surface_voxels + now.hybrid_voxels) /
                      static_cast<double>(atlas->grid().voxels());
  }

  /// Drops the selection. Does not throw.
  void draw_nothing() {
    drawn.clear();
    spans.clear();
    rays.clear();
    faces.clear();
    forget_frames();
  }

  /// Frames so far show another selection, or parts that are missing now.
  void forget_frames() { first_shown = frames + 1; }

  [[nodiscard]] Result<void> render(const Camera& camera, const RenderOptions& options,
                                    const RenderOverrides& overrides, TaskControl& task, Frame& frame) {
    frame.picker = nullptr;
    SPLATLAS_ASSIGN_OR_RETURN(const View view, view_of(camera, options.size, atlas->display()));
    SPLATLAS_RETURN_IF_ERROR(check_ids(options, *atlas));
    SPLATLAS_RETURN_IF_ERROR(check_size(options, max_memory_bytes));
    const FrameCall call{view, options, overrides, task};
    SPLATLAS_RETURN_IF_ERROR(render(call, frame));
    frame.stats = stats;
    frame.missing = decoded.missing();
    return {};
  }

  [[nodiscard]] Result<void> render(const FrameCall& call, Frame& frame) {
    stats.rays = draws_by_rays(drawn.plan(), call.view, call.options);
    if (!stats.rays) return render_sheets(call, frame);
    Result<void> rendered = render_rays(call, frame);
    const bool is_too_large = !rendered && rendered.error().code == ErrorCode::kLimit;
    if (needs_rays(call.view, call.options) || !is_too_large) return rendered;
    stats.rays = false;
    return render_sheets(call, frame);
  }

  /// Fits a camera to the selection, or to its part in some structures.
  [[nodiscard]] Result<Camera> fit(const Camera& camera, const RenderOptions& options,
                                   std::optional<std::span<const StructureIndex>> structures,
                                   const PictureRegion& region) {
    SPLATLAS_ASSIGN_OR_RETURN(FitFrame frame, FitFrame::of(camera, options.size, atlas->display(), region));
    SPLATLAS_RETURN_IF_ERROR(check_size(options, max_memory_bytes));

    // Decode the data of the picture; for drafts within a budget no more than tells the extents
    Stopwatch watch;
    const Axis axis = draws_by_rays(drawn.plan(), frame.view(), options)
                          ? Axis::kZ
                          : factorise(frame.view().plane, atlas->grid()).principal;
    const bool rough = may_be_rough(options) && options.cuts.empty();
    const int level = rough ? decoded.quick_level(drawn.plan()) : 0;
    SPLATLAS_RETURN_IF_ERROR(decode(axis, options, rough ? VoxelParts::kRuns : parts_of(options), level));
    fit_decode_ms += watch.lap().wall_ms;

    const DrawPlan part = structures ? part_of(drawn.plan(), *structures, *atlas) : drawn.plan();
    const auto extents_in_frame = [&] {
      return extents_of(part, *atlas, decoded.cache(), axis, level, options.cuts,
                        frame.planes(index_to_lps_mm(atlas->grid())), pool);
    };
    FitExtents extents = extents_in_frame();
    for (int n = 0; n < kMaxFitSteps && !extents.empty() && frame.narrow(extents); ++n)
      extents = extents_in_frame();
    stats.select_ms += watch.lap().wall_ms;
    return within_reach(extents.empty() ? frame.whole() : frame.fitted(extents));
  }

  /// Renders by shear-warp factorisation: parallel projection, pre-classification.
  [[nodiscard]] Result<void> render_sheets(const FrameCall& call, Frame& frame) {
    const auto& [view, options, overrides, task] = call;
    if (!walks_rays(options)) rays.clear();
    SPLATLAS_ASSIGN_OR_RETURN(const Shear shear, shear_of(view.plane, atlas->grid(), overrides));

    SPLATLAS_ASSIGN_OR_RETURN(const bool by_blocks,
                              decode_for(call, shear.principal, shear.voxel_pixels(), [&] {
                                return spans.require_blocks(span_source(call.options), pool);
                              }));
    Stopwatch watch;

    // Build the ray volume of ids and depths first: the spans take the memory that it leaves
    task.begin_stage(kPrepared, walks_rays(options) ? 6 : 2);
    if (walks_rays(options)) {
      if (!rays.fits_walk()) spans.clear();
      SPLATLAS_RETURN_IF_ERROR(rays.require_walk(view, options, atlas, drawn, decoded.cache(),
                                                 max_memory_bytes - frame_bytes(options), pool));
    }
    const Elapsed of_walk = watch.lap();
    stats.select_ms += of_walk.wall_ms;

    // Merge runs to spans
    const Lighting lighting(view.plane);
    const double select_ms = stats.select_ms;
    const std::uint64_t memory_for_spans =
        memory_left(max_memory_bytes, frame_bytes(options) + decoded.cache().bytes() + rays.bytes());
    const SheetVolume volume = by_blocks ? spans.prepare_blocks(view.plane, shear.principal,
                                                                options.hybrid_shading, lighting, stats, pool)
                                         : spans.prepare(span_source(options), view.plane, shear, lighting,
                                                         options, memory_for_spans, stats, pool);
    stats.traversal += of_walk;

    // Rasterise surfaces, render sheets, resolve both into the picture
    const std::vector<SurfaceDraw> surfaces = drawn.surfaces(decoded.cache(), stats.surface_level);
    const FrameScene scene = scene_of(call, surfaces, lighting);
    SheetFrame stages(scene, volume, buffers, stats, pool);
    SPLATLAS_RETURN_IF_ERROR(run_stages(stages, kSheetLoops, call, frame));
    stats.render_ms = watch.lap().wall_ms - (stats.select_ms - select_ms);
    if (by_blocks) forget_frames();  // picks need the voxels
    spans.took(stats, options);
    decoded.took(stats, options);
    return {};
  }

  /// Renders by ray casting: perspective projection or post-classification.
  [[nodiscard]] Result<void> render_rays(const FrameCall& call, Frame& frame) {
    const auto& [view, options, overrides, task] = call;
    const std::uint64_t max_bytes = max_memory_bytes - frame_bytes(options);
    if (!rays.fits(options)) spans.clear();
    SPLATLAS_ASSIGN_OR_RETURN(const bool by_blocks,
                              decode_for(call, Axis::kZ, voxel_pixels_of(view, atlas->grid()), [&] {
                                return rays.require_blocks(call.options, atlas, drawn, max_bytes, pool);
                              }));
    Stopwatch watch;

    // Build the ray volume, and light it
    stats.strips = false;
    task.begin_stage(kPrepared, 4);
    if (!by_blocks)
      SPLATLAS_RETURN_IF_ERROR(rays.require(view, options, *atlas, drawn, decoded.cache(), max_bytes, pool));
    stats.level = rays.level();
    stats.traversal = watch.lap();
    stats.select_ms += stats.traversal.wall_ms;
    const Lighting lighting(view.plane);
    rays.volume().light(view.plane, lighting, pool);
    const Elapsed light = watch.lap();
    stats.traversal += light;

    // Rasterise surfaces, cast rays, resolve both into the picture
    const std::vector<SurfaceDraw> surfaces = drawn.surfaces(decoded.cache(), stats.surface_level);
    const FrameScene scene = scene_of(call, surfaces, lighting);
    RayFrame stages(scene, rays.scene(atlas->grid()), buffers, stats, pool);
    SPLATLAS_RETURN_IF_ERROR(run_stages(stages, kRayLoops, call, frame));
    stats.runs_visited = rays.volume().runs();
    stats.render_ms = light.wall_ms + watch.lap().wall_ms;
    if (by_blocks) forget_frames();  // picks need the voxels
    rays.took(stats, options);
    decoded.took(stats, options);
    return {};
  }

  /// Decodes the selection of a frame. True if blocks that require_blocks() reads stand in for its volume.
  template <typename RequireBlocks>
  [[nodiscard]] Result<bool> decode_for(const FrameCall& call, Axis axis, double voxel_pixels,
                                        const RequireBlocks& require_blocks) {
    const RenderOptions& options = call.options;
    call.task.begin_stage(kDecoded, 5);  // classes, their runs twice, light, surfaces
    Stopwatch watch;
    stats.surface_level = decoded.surface_level(drawn.plan(), voxel_pixels, options, pool);
    if (stats.surface_level > 0 && shows_faces(options))  // faces need level 0
      SPLATLAS_RETURN_IF_ERROR(decode(axis, options, VoxelParts::kNone));
    // Surfaces first: a damaged one leaves the plan, and blocks are those of a plan
    const bool waits = decoded.waits_for_values(drawn.plan(), voxel_pixels, options, pool);
    if (waits) SPLATLAS_RETURN_IF_ERROR(decode(axis, options, VoxelParts::kNone, stats.surface_level));
    const bool by_blocks = waits && require_blocks();
    if (!by_blocks && walks_rays(options))
      SPLATLAS_RETURN_IF_ERROR(decode(Axis::kZ, options, parts_of(options), stats.surface_level));
    if (!by_blocks) SPLATLAS_RETURN_IF_ERROR(decode(axis, options, parts_of(options), stats.surface_level));
    stats.decode_ms = std::exchange(fit_decode_ms, 0) + watch.lap().wall_ms;
    return by_blocks;
  }
  [[nodiscard]] static VoxelParts parts_of(const RenderOptions& options) {
    return options.hybrid_shading ? VoxelParts::kNormals : VoxelParts::kValues;
  }
  /// Reads and decodes the parts of the plan that are not in the cache. Removes damaged parts from the plan.
  [[nodiscard]] Result<void> decode(Axis axis, const RenderOptions& options, VoxelParts parts,
                                    int surface_level = 0) {
    SPLATLAS_ASSIGN_OR_RETURN(std::optional<DrawPlan> rest,
                              decoded.require(drawn.plan(), axis, parts, surface_level, pool));
    if (rest) draw(*std::move(rest));
    if (parts == VoxelParts::kNormals) decoded.light(drawn.plan(), drawn.appearances(), pool);
    if (!decoded.missing().empty() && drawn.draws_nothing())
      return tl::unexpected(decoded.missing().front().error);
    return faces.require(options, axis, *atlas, drawn, decoded, pool);
  }

  [[nodiscard]] SpanSource span_source(const RenderOptions& options) const {
    return {drawn.plan(), drawn.appearances(), drawn.selection(),
            atlas,        decoded.cache(),     options.hybrid_shading};
  }
  [[nodiscard]] FrameScene scene_of(const FrameCall& call, std::span<const SurfaceDraw> surfaces,
                                    const Lighting& lighting) {
    return {.surfaces = surfaces,
            .view = call.view,
            .grid = atlas->grid(),
            .lighting = lighting,
            .options = call.options,
            .overrides = call.overrides,
            .max_memory_bytes = max_memory_bytes,
            .faces = faces.faces(),
            .walked = walks_rays(call.options) ? std::optional(rays.scene(atlas->grid())) : std::nullopt};
  }

  /// Runs the stages of a frame.
  [[nodiscard]] Result<void> run_stages(FrameRenderer& stages, std::size_t volume_loops,
                                        const FrameCall& call, Frame& frame) {
    SPLATLAS_RETURN_IF_ERROR(stages.run(volume_loops, call.task, frame.picture));
    shown = stages.shown();
    ++frames;
    std::swap(frame.ids, buffers.ids);  // empty without ids
    buffers.ids.numbers.clear();
    frame.depths = call.options.depths ? std::exchange(buffers.depths, {}) : DepthMap{};
    return {};
  }

  /// Picks in the n-th frame.
  [[nodiscard]] std::optional<Pick> pick(const ShownFrame& frame, std::uint64_t n, const IdImage& ids,
                                         double x, double y) {
    const PictureSize& size = frame.view.plane.size;
    if (n < first_shown || !(x >= 0 && y >= 0 && x < size.width && y < size.height)) return std::nullopt;
    const auto column = static_cast<std::int32_t>(x), row = static_cast<std::int32_t>(y);
    if (!buffers.picked.holds(n, row) &&
        !rasterize_again(frame, n, drawn.surfaces(decoded.cache(), frame.surface_level), atlas->grid(),
                         column, row, buffers, pool))
      return std::nullopt;
    const Axis axis = frame.sheets.value_or(Axis::kZ);
    const SelectedRuns* runs = frame.sheets ? spans.runs(axis) : nullptr;
    std::optional<SelectedRuns> own_runs;
    if (runs == nullptr) runs = &own_runs.emplace(drawn.plan(), atlas->classes(), decoded.cache(), axis);
    const PickScene scene{.frame = frame,
                          .grid = atlas->grid(),
                          .runs = *runs,
                          .plan = drawn.plan(),
                          .appearances = drawn.appearances().appearances(),
                          .cache = decoded.cache(),
                          .fragments = buffers.fragments,
                          .ids = ids};
    return pick_structure(scene, x, y);
  }

  std::shared_ptr<const Atlas> atlas;
  ThreadPool pool;
  const std::uint64_t max_memory_bytes;

  // State of the current selection.
  DrawnSelection drawn;
  DecodedSelection decoded;
  SpanStore spans;
  RayStore rays;
  FaceStore faces;

  // State of frames: the current one, and how finished ones are picked.
  FrameBuffers buffers;
  RenderStats stats;
  ShownFrame shown;               // the latest finished one
  std::uint64_t frames = 0;       // finished so far
  std::uint64_t first_shown = 1;  // the first one of the current draw plan
  double fit_decode_ms = 0;       // of calls of fit() since the latest frame
};

Renderer::Renderer(std::shared_ptr<const Atlas> atlas, const RendererOptions& options)
    : impl_(std::make_shared<Impl>(std::move(atlas), options)) {}

const Atlas& Renderer::atlas() const {
  return *impl_->atlas;
}
const Selection& Renderer::selection() const {
  return impl_->drawn.selection();
}

Result<void> Renderer::select(const Selection& selection) {
  return as_errors_of(impl_->atlas->name(), [&] {
    const TaskControl task({}, {}, &impl_->atlas->work_budget());
    try {
      return impl_->select(selection);
    } catch (...) {
      impl_->draw_nothing();  // half selected
      throw;
    }
  });
}

Result<Camera> Renderer::fit(const Camera& camera, const RenderOptions& options,
                             std::optional<std::span<const StructureIndex>> structures,
                             const PictureRegion& region, const RenderControl& control) {
  return as_errors_of(impl_->atlas->name(), [&] {
    const TaskControl task(control.stop, {}, &impl_->atlas->work_budget());
    return impl_->fit(camera, options, structures, region);
  });
}

void Renderer::rest() {
  impl_->buffers = {};
  impl_->spans.keep_latest();
}

Result<Frame> Renderer::render(const Camera& camera, const RenderOptions& options,
                               const RenderControl& control) {
  Frame frame;
  SPLATLAS_RETURN_IF_ERROR(render(camera, options, frame, control));
  return frame;
}

Result<void> Renderer::render(const Camera& camera, const RenderOptions& options, Frame& frame,
                              const RenderControl& control) {
  return RendererInternals::render(*this, camera, options, {}, frame, control);
}

Result<void> RendererInternals::render(Renderer& renderer, const Camera& camera, const RenderOptions& options,
                                       const RenderOverrides& overrides, Frame& frame,
                                       const RenderControl& control) {
  Renderer::Impl& r = *renderer.impl_;
  return as_errors_of(r.atlas->name(), [&] {
    TaskControl task(control.stop, control.progress, &r.atlas->work_budget());
    Result<void> rendered = r.render(camera, options, overrides, task, frame);
    if (!rendered) return rendered;
    task.finish();
    const std::weak_ptr<Renderer::Impl> weak = renderer.impl_;
    frame.picker = [weak, shown = r.shown, n = r.frames](double x, double y, const IdImage& ids) {
      const auto impl = weak.lock();
      return impl ? impl->pick(shown, n, ids, x, y) : std::nullopt;
    };
    return rendered;
  });
}

}  // namespace splatlas

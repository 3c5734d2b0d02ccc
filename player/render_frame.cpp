#include "player/render_frame.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <new>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "format/system/memory_limit.h"
#include "format/system/result_macros.h"
#include "format/system/thread_pool.h"
#include "player/depth_cue/depth_edges.h"
#include "player/frame/draw_frame.h"
#include "player/frame/pick_structure.h"
#include "player/frame/render_overrides.h"
#include "player/frame/surface_depths.h"
#include "player/rays/cast_rays.h"
#include "player/rays/cast_surfaces.h"
#include "player/rays/ray_depths.h"
#include "player/rays/ray_volume.h"
#include "player/sheets/span_depths.h"
#include "player/spans/axis_spans.h"
#include "player/spans/class_cache.h"
#include "player/spans/span_model.h"
#include "player/transfer/shading.h"
#include "player/transfer/volume_appearances.h"

namespace splatlas {
namespace {

/// A forced principal axis may not be closer than about half a degree to a right angle to the view.
constexpr double kMaxSlope = 100;

bool cues_depth(const RenderOptions& options) {
  return options.depth_cue == DepthCue::kEdges && options.depth_cue_strength > 0;
}

/// What a picture needs on its way to a file, and its depths.
std::uint64_t frame_bytes(const RenderOptions& options) {
  const std::uint64_t pixels =
      static_cast<std::uint64_t>(options.size.width) * static_cast<std::uint64_t>(options.size.height);
  return picture_bytes(options.size) + (cues_depth(options) ? pixels * sizeof(float) : 0);
}

/// How finely rays are sampled.
CastOptions cast_options(const RenderOptions& options, const RenderOverrides& overrides) {
  CastOptions cast{.floor = termination_threshold(options), .principal_axis = overrides.principal_axis};
  switch (options.quality) {
    case Quality::kDraft: break;
    case Quality::kNormal:
      cast.max_steps = 32;
      cast.tolerance = 0.054f;
      break;
    case Quality::kHigh:
      cast.min_steps = 8;
      cast.max_steps = 64;
      cast.tolerance = 0.0046f;
      break;
  }
  return cast;
}

}  // namespace

struct Renderer::Impl {
  /// What rays march through, of the current selection.
  struct Rays {
    RayVolume volume;
    Classification classification = Classification::kBefore;
    bool shaded = false;
    std::uint64_t runs = 0;
    std::optional<ParallelView> lit_for;  ///< view whose light the shaded voxels have
  };

  /// A frame that something can be picked in.
  struct Shown {
    View view;
    std::optional<Axis> sheets;  ///< slices are normal to it; none: a frame of rays
    std::size_t depth_axis = 2;  ///< of the fragments
    double depth_sign = 1;
  };

  Impl(std::shared_ptr<const Atlas> opened, const RendererOptions& options)
      : atlas(std::move(opened)),
        pool(options.threads),
        cache(atlas),
        max_memory_bytes(options.max_memory_bytes > 0 ? options.max_memory_bytes : default_memory_limit()),
        appearances(*atlas) {}

  void adopt(DrawPlan new_plan);
  [[nodiscard]] Result<void> decode(Axis axis, bool shade);
  [[nodiscard]] Result<void> leave_out_damaged();
  [[nodiscard]] AxisSpans& spans(Axis axis, bool shade);
  void keep_spans();
  void drop_kept_spans(std::uint64_t frame_bytes);
  [[nodiscard]] Result<Rays*> ray_volume(const RenderOptions& options);
  [[nodiscard]] Result<void> render_sheets(const View& frame_view, const RenderOptions& options,
                                           const RenderOverrides& overrides, Picture& picture);
  [[nodiscard]] Result<void> render_rays(const View& frame_view, const RenderOptions& options,
                                         const RenderOverrides& overrides, Picture& picture);
  template <typename AddVolumeDepths>
  void cue_depth(const RenderOptions& options, const Shown& drawn, Picture& picture,
                 const AddVolumeDepths& add_volume_depths);
  [[nodiscard]] std::vector<SurfaceDraw> surface_draws() const;
  [[nodiscard]] tl::unexpected<Error> out_of_memory() const {
    return fail(ErrorCode::kLimit, atlas->name() + ": out of memory; take a smaller size or select less");
  }

  std::shared_ptr<const Atlas> atlas;
  ThreadPool pool;
  ClassCache cache;
  std::uint64_t max_memory_bytes;

  Selection selection;
  DrawPlan plan;
  std::uint64_t plan_bytes = 0;  // what the plan's spans may take
  std::vector<MissingPart> missing;
  VolumeAppearances appearances;  // of plan.classes
  std::array<std::optional<AxisSpans>, 3> axis_spans;
  Axis latest_axis = Axis::kZ;
  std::optional<Rays> rays;

  // Of the latest frame.
  FrameBuffers frame;
  DepthMap depths;
  std::optional<Shown> shown;
  RenderStats stats;
};

/// What is drawn from now on.
void Renderer::Impl::adopt(DrawPlan new_plan) {
  plan = std::move(new_plan);
  appearances.select(plan, selection);
  keep_spans();
  rays.reset();
  shown.reset();
  stats.volume_voxels = plan.volume_voxels;
  stats.surface_voxels = plan.surface_voxels;
  stats.hybrid_voxels = plan.hybrid_voxels;
  stats.occupancy = static_cast<double>(plan.volume_voxels + plan.surface_voxels + plan.hybrid_voxels) /
                    static_cast<double>(atlas->grid().voxels());
}

/// Reads and decodes what the selection needs and the cache does not have yet.
Result<void> Renderer::Impl::decode(Axis axis, bool shade) {
  Result<void> classes = cache.require(volume_classes(plan), axis, pool, shade);
  if (!classes && cache.failed_classes().empty()) return classes;
  if (!cache.require_surfaces(plan.surfaces, pool) || !classes) SPLATLAS_RETURN_IF_ERROR(leave_out_damaged());
  if (!missing.empty() && volume_classes(plan).empty() && plan.surfaces.empty()) {
    return tl::unexpected(missing.front().error);
  }
  return {};
}

/// Goes on without what could not be read. Want of memory is no damage.
Result<void> Renderer::Impl::leave_out_damaged() {
  const auto check = [](const auto& failed) -> Result<void> {
    for (const auto& of : failed) {
      if (of.error.code == ErrorCode::kLimit) return tl::unexpected(of.error);
    }
    return {};
  };
  SPLATLAS_RETURN_IF_ERROR(check(cache.failed_classes()));
  SPLATLAS_RETURN_IF_ERROR(check(cache.failed_surfaces()));
  DrawPlan rest = plan;
  for (MissingPart& part :
       leave_out(cache.failed_classes(), cache.failed_surfaces(), atlas->classes(), rest)) {
    const auto known = std::ranges::find_if(missing, [&](const MissingPart& other) {
      return other.structure == part.structure && other.surface == part.surface;
    });
    if (known == missing.end()) {
      missing.push_back(std::move(part));
    } else {
      known->voxels += part.voxels;
    }
  }
  try {
    adopt(std::move(rest));
  } catch (const std::bad_alloc&) {
    plan = {};  // nothing is left, which decode() tells
    throw;
  }
  return {};
}

/// Once per selection and axis.
AxisSpans& Renderer::Impl::spans(Axis axis, bool shade) {
  latest_axis = axis;
  std::optional<AxisSpans>& built = axis_spans[static_cast<std::size_t>(axis)];
  if (!built) built.emplace();
  if (!built->current(shade)) built->build(plan, appearances, *atlas, cache, axis, shade, pool);
  return *built;
}

/// What stays selected is not built again for the axis in use; spans of other axes go.
void Renderer::Impl::keep_spans() {
  for (const Axis axis : kAxes) {
    std::optional<AxisSpans>& built = axis_spans[static_cast<std::size_t>(axis)];
    if (!built) continue;
    if (axis == latest_axis) {
      built->outdate();
    } else {
      built.reset();
    }
  }
}

/// Makes room: spans of a selection before are built upon only where there is memory for all.
void Renderer::Impl::drop_kept_spans(std::uint64_t frame_bytes) {
  for (std::optional<AxisSpans>& built : axis_spans) {
    if (built && !built->current(false) &&
        built->optical_bytes() + plan_bytes + frame_bytes > max_memory_bytes) {
      built.reset();
    }
  }
}

/// What rays march through, once per selection and classification. Spans make room for it.
Result<Renderer::Impl::Rays*> Renderer::Impl::ray_volume(const RenderOptions& options) {
  if (!rays || rays->classification != options.classification || rays->shaded != options.hybrid_shading) {
    rays.reset();
    for (auto& spans : axis_spans) spans.reset();
    const SelectedRuns runs(plan, atlas->classes(), cache, Axis::kZ);
    const RayVolumeRequest request{.atlas = *atlas,
                                   .selection = selection,
                                   .plan = plan,
                                   .appearances = appearances.appearances(),
                                   .runs = runs,
                                   .cache = cache,
                                   .classification = options.classification,
                                   .shade = options.hybrid_shading,
                                   .max_memory_bytes = max_memory_bytes - frame_bytes(options)};
    SPLATLAS_ASSIGN_OR_RETURN(RayVolume volume, RayVolume::build(request, pool));
    rays =
        Rays{std::move(volume), options.classification, options.hybrid_shading, runs.count(), std::nullopt};
  }
  return &*rays;
}

/// A frame of sheets: in parallel projection, voxels classified before interpolation.
Result<void> Renderer::Impl::render_sheets(const View& frame_view, const RenderOptions& options,
                                           const RenderOverrides& overrides, Picture& picture) {
  rays.reset();
  const ParallelView& view = frame_view.plane;
  const Grid& grid = atlas->grid();
  const Shear shear = factorise(view, grid, overrides.principal_axis ? &*overrides.principal_axis : nullptr);
  if (!(std::abs(shear.slope_u) <= kMaxSlope && std::abs(shear.slope_v) <= kMaxSlope)) {
    return fail(ErrorCode::kUsage,
                fmt::format("principal axis {}: the view runs along its slices; take another",
                            "xyz"[static_cast<std::size_t>(shear.principal)]));
  }

  Stopwatch watch;
  SPLATLAS_RETURN_IF_ERROR(decode(shear.principal, options.hybrid_shading));
  stats.decode_ms = watch.lap().wall_ms;

  AxisSpans& built = spans(shear.principal, options.hybrid_shading);
  stats.traversal = watch.lap();
  stats.select_ms += stats.traversal.wall_ms;

  const Lighting lighting(view);
  built.light(view, lighting, options.hybrid_shading, pool);
  const Elapsed light = watch.lap();
  stats.traversal += light;

  const std::vector<SurfaceDraw> surfaces = surface_draws();
  shown.reset();  // what the latest frame left is overwritten now, whether this one succeeds or not
  SPLATLAS_ASSIGN_OR_RETURN(const FrameCounters drawn, draw_frame({.spans = built.model(),
                                                                   .surfaces = surfaces,
                                                                   .view = view,
                                                                   .shear = shear,
                                                                   .grid = grid,
                                                                   .lighting = lighting,
                                                                   .options = options,
                                                                   .max_memory_bytes = max_memory_bytes,
                                                                   .simd = overrides.simd},
                                                                  frame, picture, pool));
  const Shown now{frame_view, shear.principal, shear.scan.slice_axis, shear.ascending ? 1.0 : -1.0};
  cue_depth(options, now, picture, [&](const ViewDepth& view_depth) {
    add_span_depths(built.model(), shear, view_depth, depths, pool);
  });
  shown = now;
  stats.runs_visited = built.runs().count();
  stats.voxels_visited = drawn.voxels;
  stats.triangles = drawn.triangles;
  stats.rasterize = drawn.rasterize;
  stats.sheets = drawn.sheets;
  stats.resolve = drawn.resolve;
  stats.render_ms = light.wall_ms + watch.lap().wall_ms;
  return {};
}

/// A frame of rays: in perspective, and wherever grey values are classified after interpolation.
Result<void> Renderer::Impl::render_rays(const View& frame_view, const RenderOptions& options,
                                         const RenderOverrides& overrides, Picture& picture) {
  shown.reset();  // what the latest frame left is overwritten now
  Stopwatch watch;
  SPLATLAS_RETURN_IF_ERROR(decode(Axis::kZ, options.hybrid_shading));
  stats.decode_ms = watch.lap().wall_ms;
  SPLATLAS_ASSIGN_OR_RETURN(Rays* const cast, ray_volume(options));
  stats.traversal = watch.lap();
  stats.select_ms += stats.traversal.wall_ms;
  const Lighting lighting(frame_view.plane);
  if (cast->shaded && cast->volume.shaded() &&
      !(cast->lit_for && have_same_light(*cast->lit_for, frame_view.plane))) {
    cast->volume.shade(lighting.table(), pool);
    cast->lit_for = frame_view.plane;
  }
  const Elapsed light = watch.lap();
  stats.traversal += light;

  const std::vector<SurfaceDraw> surfaces = surface_draws();
  SPLATLAS_ASSIGN_OR_RETURN(const RasterScene scene,
                            raster_scene_of_rays(surfaces, frame_view, atlas->grid(), lighting));
  SPLATLAS_ASSIGN_OR_RETURN(
      const RasterCounters raster,
      frame.rasterizer.draw(scene, raster_options(options, max_memory_bytes), frame.fragments, pool));
  stats.triangles = raster.triangles;
  stats.rasterize = watch.lap();

  const MarchKernels& kernels = overrides.simd ? best_march() : scalar_march();
  cast_rays(cast->volume, frame_view, atlas->grid(), cast_options(options, overrides), kernels, picture,
            pool);
  stats.sheets = watch.lap();
  cast_surfaces(cast->volume, frame_view, atlas->grid(), scene, frame.fragments,
                cast_options(options, overrides), kernels, picture, pool);
  stats.resolve = watch.lap();
  const Shown drawn{frame_view, std::nullopt, scene.depth_axis, scene.depth_sign};
  cue_depth(options, drawn, picture, [&](const ViewDepth& view_depth) {
    add_ray_depths(cast->volume, frame_view, atlas->grid(), kernels, view_depth, depths, pool);
  });
  shown = drawn;
  stats.runs_visited = cast->runs;
  stats.voxels_visited = cast->volume.voxels();
  stats.render_ms = light.wall_ms + stats.rasterize.wall_ms + stats.sheets.wall_ms + stats.resolve.wall_ms +
                    stats.depth_cue.wall_ms;
  return {};
}

/// `add_volume_depths(view_depth)` adds those of the volume to the surfaces'.
template <typename AddVolumeDepths>
void Renderer::Impl::cue_depth(const RenderOptions& options, const Shown& drawn, Picture& picture,
                               const AddVolumeDepths& add_volume_depths) {
  Stopwatch watch;
  if (cues_depth(options)) {
    const ViewDepth view_depth(drawn.view, atlas->grid());
    depths.clear(options.size);
    add_surface_depths(frame.fragments, drawn.depth_axis, drawn.depth_sign, view_depth, depths);
    add_volume_depths(view_depth);
    darken_edges(depths, depth_edges(drawn.view.plane, options.depth_cue_strength), picture, pool);
  }
  stats.depth_cue = watch.lap();
}

std::vector<SurfaceDraw> Renderer::Impl::surface_draws() const {
  std::vector<SurfaceDraw> draws;
  for (const StructureIndex s : plan.surfaces) {
    draws.push_back(surface_draw(s, selection.structures[s], cache.surface(s)));
  }
  return draws;
}

Renderer::Renderer(std::shared_ptr<const Atlas> atlas, const RendererOptions& options)
    : impl_(std::make_unique<Impl>(std::move(atlas), options)) {}
Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

const Atlas& Renderer::atlas() const {
  return *impl_->atlas;
}
const RenderStats& Renderer::stats() const {
  return impl_->stats;
}

const std::vector<MissingPart>& Renderer::missing() const {
  return impl_->missing;
}

Result<void> Renderer::select(const Selection& selection) try {
  Stopwatch watch;
  Impl& r = *impl_;
  DrawPlan plan = r.atlas->tree().plan(selection);
  const std::uint64_t voxels = plan.volume_voxels + plan.hybrid_voxels;
  std::uint64_t runs = 0;  // of the worst axis, as if all were selected: the selection's are not known yet
  for (const Axis axis : kAxes) runs = std::max(runs, r.atlas->runs(axis));
  const std::uint64_t bytes = span_model_bytes(voxels, std::min(runs, voxels));
  if (bytes > r.max_memory_bytes) {
    return fail(
        ErrorCode::kLimit,
        fmt::format(
            "{}: the selection has {} volume voxels, which take up to {} MiB; {} MiB are allowed. Select "
            "less, or surfaces only",
            r.atlas->name(), voxels, bytes >> 20, r.max_memory_bytes >> 20));
  }
  r.selection = selection;
  r.plan_bytes = bytes;
  r.missing.clear();
  r.stats = {};
  r.adopt(std::move(plan));
  r.stats.select_ms = watch.lap().wall_ms;
  return {};
} catch (const std::bad_alloc&) {
  impl_->plan = {};
  return impl_->out_of_memory();
}

Result<Picture> Renderer::render(const Camera& camera, const RenderOptions& options) {
  Picture picture;
  SPLATLAS_RETURN_IF_ERROR(render(camera, options, picture));
  return picture;
}

Result<void> Renderer::render(const Camera& camera, const RenderOptions& options, Picture& picture) {
  return render_with(*this, camera, options, {}, picture);
}

Result<Picture> render_with(Renderer& renderer, const Camera& camera, const RenderOptions& options,
                            const RenderOverrides& overrides) {
  Picture picture;
  SPLATLAS_RETURN_IF_ERROR(render_with(renderer, camera, options, overrides, picture));
  return picture;
}

Result<void> render_with(Renderer& renderer, const Camera& camera, const RenderOptions& options,
                         const RenderOverrides& overrides, Picture& picture) try {
  Renderer::Impl& r = *renderer.impl_;
  SPLATLAS_ASSIGN_OR_RETURN(const View view, view_of(camera, options.size, r.atlas->display()));
  const std::uint64_t bytes = frame_bytes(options);
  r.drop_kept_spans(bytes);
  if (bytes > r.max_memory_bytes - r.plan_bytes) {
    return fail(
        ErrorCode::kLimit,
        fmt::format("{}: a picture of {}x{} pixels takes {} MiB, and the selection's volumes up to {} "
                    "MiB; {} MiB are allowed. Take a smaller size",
                    r.atlas->name(), options.size.width, options.size.height, bytes >> 20, r.plan_bytes >> 20,
                    r.max_memory_bytes >> 20));
  }
  const bool by_rays = view.eye_mm || options.classification == Classification::kAfter;
  return by_rays ? r.render_rays(view, options, overrides, picture)
                 : r.render_sheets(view, options, overrides, picture);
} catch (const std::bad_alloc&) {
  return renderer.impl_->out_of_memory();
}

std::optional<Pick> Renderer::pick(double x, double y) const {
  const Impl& r = *impl_;
  if (!r.shown) return std::nullopt;
  const Impl::Shown& shown = *r.shown;
  const auto pick_among = [&](const SelectedRuns& runs) {
    const PickScene scene{.grid = r.atlas->grid(),
                          .runs = runs,
                          .plan = r.plan,
                          .appearances = r.appearances.appearances(),
                          .cache = r.cache,
                          .fragments = r.frame.fragments,
                          .depth_axis = shown.depth_axis,
                          .depth_sign = shown.depth_sign};
    return pick_structure(scene, shown.view, shown.sheets, x, y);
  };
  if (!shown.sheets) return pick_among(SelectedRuns(r.plan, r.atlas->classes(), r.cache, Axis::kZ));
  const auto& spans = r.axis_spans[static_cast<std::size_t>(*shown.sheets)];
  if (!spans || !spans->current(false)) return std::nullopt;
  return pick_among(spans->runs());
}

}  // namespace splatlas

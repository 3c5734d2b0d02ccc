#include "bench/experiments/full_traversal.h"

#include <array>
#include <utility>

#include "bench/experiments/walked_spans.h"
#include "format/result_macros.h"
#include "player/render/frame/stopwatch.h"

namespace splatlas {
namespace {

/// Tests the class of every voxel, slice by slice and scanline by scanline.
SpanModel visit_voxels(const VoxelModel& model, const WalkedScene& scene, Axis axis, ThreadPool& pool) {
  const std::vector<std::uint32_t> draw_of_class = draws_by_class(scene.plan, scene.classes.size());
  const ScanOrder scan = ScanOrder::of(axis);
  const Index3& size = model.grid.size;
  const Index3 step{1, size[0], size[0] * size[1]};
  const auto voxels = static_cast<std::uint32_t>(size[scan.scan_axis]);
  return walk_spans(scene, axis, pool, [&](std::int64_t slice, const auto& take) {
    for (std::uint32_t row = 0; row < size[scan.row_axis]; ++row) {
      const ClassId* const line =
          model.classes.data() + slice * step[scan.slice_axis] + row * step[scan.row_axis];
      const auto draw_of = [&](std::uint32_t n) { return draw_of_class[line[n * step[scan.scan_axis]]]; };
      for (std::uint32_t n = 0; n < voxels;) {
        const std::uint32_t draw = draw_of(n), start = n;
        do ++n;
        while (n < voxels && draw_of(n) == draw);
        if (draw != kNotDrawn) take(WalkedRun{row, start, n - start, draw});
      }
    }
  });
}

}  // namespace

Result<VoxelModel> read_voxel_model(const Atlas& atlas) {
  SPLATLAS_ASSIGN_OR_RETURN(AtlasContent content, atlas.read_all());
  VoxelModel model;
  model.grid = atlas.grid();
  model.classes = std::move(content.class_volume);
  model.values = std::move(content.values);
  model.surfaces = std::move(content.surfaces);
  return model;
}

FullTraversal::FullTraversal(std::shared_ptr<const Atlas> atlas, const VoxelModel& model, unsigned threads,
                             FindSpans find_spans)
    : atlas_(std::move(atlas)),
      model_(model),
      pool_(threads),
      find_spans_(std::move(find_spans)),
      appearances_(*atlas_),
      meshes_(model.surfaces) {
  for (StructureIndex s = 0; s < meshes_.size(); ++s) {
    owners_.emplace_back(meshes_[s].triangles.size(), s);
    clusters_.emplace_back(meshes_[s], model.grid);
  }
}

void FullTraversal::select(const Selection& selection) {
  selection_ = selection;
  plan_ = atlas_->tree().plan(selection);
  appearances_.select(plan_, selection);
  draws_surface_.assign(meshes_.size(), false);
  for (const StructureIndex s : plan_.surfaces) draws_surface_[s] = true;
}

/// Collects the selected triangles of the frame, testing each.
void FullTraversal::visit_triangles() {
  pool_.for_each(meshes_.size(), [&](std::size_t s) {
    const std::vector<std::array<std::uint32_t, 3>>& all = model_.surfaces[s].triangles;
    std::vector<std::array<std::uint32_t, 3>>& drawn = meshes_[s].triangles;
    drawn.clear();
    for (std::size_t n = 0; n < all.size(); ++n) {
      if (draws_surface_[owners_[s][n]]) drawn.push_back(all[n]);
    }
  });
}

std::vector<SurfaceDraw> FullTraversal::surface_draws() const {
  std::vector<SurfaceDraw> draws;
  for (const StructureIndex s : plan_.surfaces) {
    draws.push_back(surface_draw(s, selection_.structures[s], meshes_[s], clusters_[s]));
  }
  return draws;
}

Result<FullTraversal::Frame> FullTraversal::render(const Camera& camera, const RenderOptions& options) {
  SPLATLAS_ASSIGN_OR_RETURN(const ParallelView view, parallel_view(camera, options.size, atlas_->display()));
  const Shear shear = factorise(view, model_.grid);
  const Lighting lighting(view);

  Frame frame;
  Stopwatch watch;
  const WalkedScene scene{model_.grid, model_.values.bytes.data(), plan_, appearances_.appearances(),
                          atlas_->classes()};
  const SpanModel spans = find_spans_ ? find_spans_(scene, shear.principal, pool_)
                                      : visit_voxels(model_, scene, shear.principal, pool_);
  visit_triangles();
  frame.traversal = watch.lap();

  const std::vector<SurfaceDraw> surfaces = surface_draws();
  SPLATLAS_ASSIGN_OR_RETURN(frame.drawn, draw_frame({.surfaces = surfaces,
                                                     .view = {view},
                                                     .grid = model_.grid,
                                                     .lighting = lighting,
                                                     .options = options,
                                                     .overrides = {}},
                                                    spans, shear, buffers_, frame.picture, pool_));
  frame.window = buffers_.sheet.window;
  frame.planes = 1 + spans.emissions;
  return frame;
}

}  // namespace splatlas

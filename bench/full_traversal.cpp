#include "bench/full_traversal.h"

#include <limits>
#include <utility>

#include "bench/frames.h"
#include "bench/visit_voxels.h"
#include "format/system/result_macros.h"
#include "player/frame/stopwatch.h"

namespace splatlas {

FullTraversal::FullTraversal(std::shared_ptr<const Atlas> atlas, const VoxelModel& model, unsigned threads)
    : atlas_(std::move(atlas)),
      model_(model),
      pool_(threads),
      appearances_(*atlas_),
      meshes_(model.surfaces) {
  for (StructureIndex s = 0; s < meshes_.size(); ++s) owners_.emplace_back(meshes_[s].triangles.size(), s);
}

void FullTraversal::select(const Selection& selection) {
  selection_ = selection;
  plan_ = atlas_->tree().plan(selection);
  appearances_.select(plan_, selection);
  draw_of_class_.assign(atlas_->classes().size(), VoxelSelection::kNotDrawn);
  for (std::uint32_t n = 0; n < plan_.classes.size(); ++n) {
    const ClassDraw& draw = plan_.classes[n];
    if (!draws_volume(draw.role)) continue;
    draw_of_class_[draw.id] = n;
  }
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
    draws.push_back(surface_draw(s, selection_.structures[s], meshes_[s]));
  }
  return draws;
}

Result<FullTraversal::Frame> FullTraversal::render(const Camera& camera, const RenderOptions& options) {
  SPLATLAS_ASSIGN_OR_RETURN(const ParallelView view, parallel_view(camera, options.size, atlas_->display()));
  const Shear shear = factorise(view, model_.grid);
  const Lighting lighting(view);

  Frame frame;
  Stopwatch watch;
  SpanModel spans = visit_voxels(
      model_, {draw_of_class_, plan_, appearances_.appearances(), atlas_->classes()}, shear.principal, pool_);
  if (options.hybrid_shading && spans.shaded_voxels > 0) shade_spans(spans, lighting.table(), pool_);
  visit_triangles();
  frame.traversal = watch.lap();

  const std::vector<SurfaceDraw> surfaces = surface_draws();
  SPLATLAS_ASSIGN_OR_RETURN(frame.drawn,
                            draw_frame({.spans = spans,
                                        .surfaces = surfaces,
                                        .view = view,
                                        .shear = shear,
                                        .grid = model_.grid,
                                        .lighting = lighting,
                                        .options = options,
                                        .max_memory_bytes = std::numeric_limits<std::uint64_t>::max()},
                                       buffers_, frame.picture, pool_));
  return frame;
}

}  // namespace splatlas

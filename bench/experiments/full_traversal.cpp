#include "bench/experiments/full_traversal.h"

#include <algorithm>
#include <array>
#include <utility>

#include "bench/experiments/run_collector.h"
#include "format/result_macros.h"
#include "player/render/frame/stopwatch.h"
#include "player/render/sheets/spans/build_spans.h"
#include "player/render/sheets/spans/span_writer.h"

namespace splatlas {
namespace {

/// Selection in the form of the visit.
struct VoxelSelection {
  std::span<const std::uint32_t> draw_of_class;  ///< index into plan.classes, or kNotDrawn
  const DrawPlan& plan;
  std::span<const VolumeAppearance> appearances;  ///< per class of plan
  const ClassTable& classes;
};

/// One slice, row by row.
class SliceVisit {
 public:
  SliceVisit(const VoxelModel& model, const VoxelSelection& selection, const ScanOrder& scan, int emissions)
      : model_(model), selection_(selection), scan_(scan), emissions_(emissions) {
    const Index3& size = model.grid.size;
    step_ = {1, static_cast<std::size_t>(size[0]), static_cast<std::size_t>(size[0] * size[1])};
  }

  void visit(std::int64_t slice, SliceSpans& out) {
    const Index3& size = model_.grid.size;
    SpanWriter writer(emissions_, out);
    for (std::int64_t row = 0; row < size[scan_.row_axis]; ++row) {
      visit_row(slice, row, writer);
      writer.end_row(row);
    }
    writer.finish();
  }

  /// Bounds of the selected voxels, visible or not: rows in [0], positions along the scanline in [1].
  [[nodiscard]] const IndexBox& selected() const { return selected_; }

 private:
  [[nodiscard]] std::uint32_t draw_of(std::size_t voxel) const {
    return selection_.draw_of_class[model_.classes[voxel]];
  }

  void visit_row(std::int64_t slice, std::int64_t row, SpanWriter& writer) {
    const std::size_t start = static_cast<std::size_t>(slice) * step_[scan_.slice_axis] +
                              static_cast<std::size_t>(row) * step_[scan_.row_axis];
    const std::size_t step = step_[scan_.scan_axis];
    const auto voxels = static_cast<std::size_t>(model_.grid.size[scan_.scan_axis]);
    for (std::size_t n = 0; n < voxels; ++n) {
      const std::uint32_t draw = draw_of(start + n * step);
      if (draw == kNotDrawn) continue;
      const std::size_t first = n;
      while (n + 1 < voxels && draw_of(start + (n + 1) * step) == draw) ++n;
      selected_.include(
          IndexBox{{row, static_cast<std::int64_t>(first), 0}, {row, static_cast<std::int64_t>(n), 0}});
      take(start + first * step, static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(n + 1 - first),
           draw, writer);
    }
  }

  /// Appearances up the grey values of `count` voxels in a row that are drawn alike.
  void take(std::size_t voxel, std::uint32_t first, std::uint32_t count, std::uint32_t draw,
            SpanWriter& writer) {
    const std::size_t step = step_[scan_.scan_axis];
    const VolumeAppearance& appearance = selection_.appearances[draw];
    writer.add(first, count);
    appearance.look_up(model_.values.bytes.data(), voxel, step, count, writer.extinctions(first),
                       writer.whites(first));
    writer.color(first, count, appearance.color);
  }

  const VoxelModel& model_;
  const VoxelSelection& selection_;
  ScanOrder scan_;
  int emissions_;
  std::array<std::size_t, 3> step_{};
  IndexBox selected_;
};

/// Crops the model to the bounding box of the selection, as in the player.
void trim(SpanModel& model, std::span<const IndexBox> selected) {
  IndexBox box;  // slices, rows, positions along the scanline
  for (std::size_t n = 0; n < selected.size(); ++n) {
    if (selected[n].empty()) continue;
    const auto slice = static_cast<std::int64_t>(n);
    box.include(IndexBox{{slice, selected[n].first[0], selected[n].first[1]},
                         {slice, selected[n].last[0], selected[n].last[1]}});
  }
  if (box.empty()) {
    model.slices.clear();
    return;
  }
  model.slices.erase(model.slices.begin() + box.last[0] + 1, model.slices.end());
  model.slices.erase(model.slices.begin(), model.slices.begin() + box.first[0]);
  model.slice_first = box.first[0];
  model.slice_count = box.last[0] - box.first[0] + 1;
  model.row_first = box.first[1];
  model.rows = box.last[1] - box.first[1] + 1;
  model.scan_first = box.first[2];
  model.scan_voxels = box.last[2] - box.first[2] + 1;
}

/// The spans of the player, built by testing the class of every voxel of the grid, slice by slice and
/// scanline by scanline; optical properties are looked up for selected voxels only. Equal to those of the
/// player bit for bit. Cost: all voxels, plus the selected ones; slices run in parallel.
SpanModel visit_voxels(const VoxelModel& model, const VoxelSelection& selection, Axis axis,
                       ThreadPool& pool) {
  const ScanOrder scan = ScanOrder::of(axis);
  const auto slices = static_cast<std::size_t>(model.grid.size[scan.slice_axis]);
  SpanModel spans;
  spans.axis = axis;
  set_appearances(selection.plan, selection.appearances, selection.classes, spans);
  spans.slices.resize(slices);
  std::vector<IndexBox> selected(slices);
  pool.for_each(slices, [&](std::size_t n) {
    SliceVisit visit(model, selection, scan, spans.emissions);
    spans.slices[n].number = static_cast<std::int64_t>(n);
    visit.visit(static_cast<std::int64_t>(n), spans.slices[n]);
    selected[n] = visit.selected();
  });
  trim(spans, selected);
  for (const SliceSpans& slice : spans.slices) {
    spans.voxels += slice.voxels;
  }
  return spans;
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

FullTraversal::FullTraversal(std::shared_ptr<const Atlas> atlas, const VoxelModel& model, unsigned threads)
    : atlas_(std::move(atlas)),
      model_(model),
      pool_(threads),
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
  draw_of_class_ = draws_by_class(plan_, atlas_->classes().size());
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
  SpanModel spans = visit_voxels(
      model_, {draw_of_class_, plan_, appearances_.appearances(), atlas_->classes()}, shear.principal, pool_);
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
  return frame;
}

}  // namespace splatlas

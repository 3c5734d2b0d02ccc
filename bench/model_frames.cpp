#include "bench/model_frames.h"

#include <limits>
#include <utility>

#include "bench/class_draws.h"
#include "bench/frames.h"
#include "format/system/result_macros.h"
#include "player/spans/build_spans.h"
#include "player/spans/span_writer.h"

namespace splatlas {

const char* name_of(Model model) {
  switch (model) {
    case Model::kLevels: return "run models by level";
    case Model::kVoxelOctree: return "octree to voxels";
    case Model::kBrickOctree: return "octree to bricks of 8";
    case Model::kRuns: break;
  }
  return "one run model";
}

Result<Models> Models::make(std::shared_ptr<const Atlas> atlas, ThreadPool& pool) {
  constexpr std::int64_t kBrickSide = 8;
  ClassCache cache(atlas);
  std::vector<ClassId> all;
  for (ClassId c = 1; c < atlas->classes().size(); ++c) all.push_back(c);
  for (const Axis axis : kAxes) SPLATLAS_RETURN_IF_ERROR(cache.require(all, axis, pool));
  SPLATLAS_ASSIGN_OR_RETURN(const AtlasContent content, atlas->read_all());
  SPLATLAS_ASSIGN_OR_RETURN(LevelRuns levels, LevelRuns::build(*atlas));
  const Index3 size = atlas->grid().size;
  return Models{std::move(atlas), std::move(cache), std::move(levels),
                ClassOctree(content.class_volume, size, 1),
                ClassOctree(content.class_volume, size, kBrickSide)};
}

ModelFrames::ModelFrames(const Models& models, ThreadPool& pool)
    : models_(models), pool_(pool), appearances_(*models.atlas), player_(models.atlas, {.threads = 1}) {
  options_.size = {512, 512};
  options_.hybrid_shading = false;  // only the lowest level separates boundaries
}

Result<void> ModelFrames::select(std::string_view selection) {
  SPLATLAS_ASSIGN_OR_RETURN(const Selection selected, splatlas::select(selection, models_.atlas->graph()));
  plan_ = models_.atlas->tree().plan(selected);
  appearances_.select(plan_, selected);
  players_camera_.reset();
  return player_.select(selected);
}

/// Writes the spans of one slice as SpanBuilder does. Adjacent runs of equal appearance share one look-up.
template <typename Walk>
void ModelFrames::build_slice(std::int64_t slice, const Walk& walk) {
  const Grid& grid = models_.atlas->grid();
  const ScanOrder scan = ScanOrder::of(spans_.axis);
  const std::array<std::size_t, 3> step{1, static_cast<std::size_t>(grid.size[0]),
                                        static_cast<std::size_t>(grid.size[0] * grid.size[1])};
  SpanWriter writer(spans_.scan_first, spans_.scan_voxels, spans_.emissions,
                    spans_.slices[static_cast<std::size_t>(slice - spans_.slice_first)]);
  FoundRun whole;
  const auto write = [&] {
    if (whole.length == 0) return;
    const VolumeAppearance& appearance = appearances_.appearances()[whole.draw];
    const std::size_t voxel = static_cast<std::size_t>(slice) * step[scan.slice_axis] +
                              whole.row * step[scan.row_axis] + whole.start * step[scan.scan_axis];
    writer.add(whole.start, whole.length);
    appearance.look_up(models_.classes.values(), voxel, step[scan.scan_axis], whole.length,
                       writer.extinctions(whole.start), writer.emissions(whole.start, 0));
    if (spans_.emissions == 3) writer.color(whole.start, whole.length, appearance.color);
    ++runs_;
  };
  walk(slice, [&](const FoundRun& run) {
    if (run.row == whole.row && run.start == whole.start + whole.length && run.draw == whole.draw) {
      whole.length += run.length;
      return;
    }
    write();
    if (run.row != whole.row) writer.end_row(whole.row);
    whole = run;
  });
  write();
  writer.end_row(whole.row);
  writer.finish();
}

template <typename Walk>
void ModelFrames::build_spans(const SelectedRuns& selected, const Walk& walk) {
  spans_.axis = selected.axis();
  set_appearances(plan_, appearances_.appearances(), models_.atlas->classes(), spans_);
  spans_.scan_first = selected.box().first[0];
  spans_.scan_voxels = selected.scan_voxels();
  spans_.row_first = selected.box().first[1];
  spans_.rows = selected.rows();
  spans_.slice_first = selected.box().first[2];
  spans_.slices.resize(static_cast<std::size_t>(selected.slices()));  // slices keep their memory
  spans_.voxels = 0;
  runs_ = 0;
  for (std::int64_t slice = selected.box().first[2]; slice <= selected.box().last[2]; ++slice)
    build_slice(slice, walk);
  for (const SliceSpans& slice : spans_.slices) spans_.voxels += slice.voxels;
}

Result<std::vector<Elapsed>> ModelFrames::draw(Model model, int turn, int frames) {
  const Camera camera = turned(oblique_camera(), turn, frames);
  const Atlas& atlas = *models_.atlas;
  SPLATLAS_ASSIGN_OR_RETURN(const ParallelView view, parallel_view(camera, options_.size, atlas.display()));
  const Shear shear = factorise(view, atlas.grid());
  const Lighting lighting(view);

  Stopwatch watch;
  const std::vector<std::uint32_t> draws =
      shared_draws_by_class(plan_, appearances_.appearances(), atlas.classes().size());
  const SelectedRuns selected(plan_, atlas.classes(), models_.classes, shear.principal);
  const FoundRuns found = find(model, draws, shear.principal);
  const Elapsed finding = watch.lap();
  if (model == Model::kRuns) {
    build_spans(selected, [&](std::int64_t slice, const auto& take) {
      selected.for_each(slice, [&](const ClassRun& run, std::uint32_t) {
        take({run.row, run.start, run.length, draws[run.id]});
      });
    });
  } else {
    build_spans(selected, [&](std::int64_t slice, const auto& take) {
      for (const FoundRun& run : found.slice(slice)) take(run);
    });
  }
  const Elapsed building = watch.lap();
  SPLATLAS_RETURN_IF_ERROR(draw_frame({.spans = spans_,
                                       .surfaces = {},
                                       .view = view,
                                       .shear = shear,
                                       .grid = atlas.grid(),
                                       .lighting = lighting,
                                       .options = options_,
                                       .max_memory_bytes = std::numeric_limits<std::uint64_t>::max()},
                                      buffers_, picture_, pool_));
  const Elapsed drawing = watch.lap();
  SPLATLAS_RETURN_IF_ERROR(compare(camera));
  const Elapsed traversal = finding + building;
  return std::vector<Elapsed>{finding, building, traversal, drawing, traversal + drawing};
}

FoundRuns ModelFrames::find(Model model, std::span<const std::uint32_t> draws, Axis axis) const {
  if (model == Model::kRuns) return {};
  RunCollector runs(drawn_box(plan_, models_.atlas->classes()), axis);
  if (model == Model::kLevels) models_.levels.collect(draws, axis, runs);
  if (model == Model::kVoxelOctree) models_.voxel_octree.collect(draws, runs);
  if (model == Model::kBrickOctree) models_.brick_octree.collect(draws, runs);
  return runs.finish();
}

Result<void> ModelFrames::compare(const Camera& camera) {
  if (!players_camera_ || players_camera_->azimuth_deg != camera.azimuth_deg) {
    SPLATLAS_RETURN_IF_ERROR(player_.render(camera, options_, players_picture_));
    players_camera_ = camera;
  }
  bits_differ_ += splatlas::bits_differ(picture_.rgba, players_picture_.rgba);
  return {};
}

}  // namespace splatlas

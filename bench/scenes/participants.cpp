#include "bench/scenes/participants.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "bench/measure/measure.h"
#include "format/result_macros.h"
#include "tests/reference/grey_truth.h"

namespace splatlas {
namespace {

using reference::PerspectiveView;
using reference::PictureDifference;
using reference::ReferencePicture;

/// A renderer of ours with its latest frame.
struct Ours {
  Renderer renderer;
  Frame latest;
};

}  // namespace

Result<void> add_ours(const ErrorTask& task, Classification classification, unsigned threads,
                      std::vector<Participant>& participants, std::span<const NamedQuality> settings) {
  const bool rays = classification == Classification::kAfter;
  for (const NamedQuality& setting : settings) {
    // Each has its own renderer: rays of high quality would take the place of the spans of others
    const auto ours = std::make_shared<Ours>(Ours{Renderer(task.atlas, {.threads = threads}), {}});
    SPLATLAS_RETURN_IF_ERROR(ours->renderer.select(task.model.selection));
    const RenderOptions options{.size = task.size,
                                .quality = setting.quality,
                                .classification = classification,
                                .hybrid_shading = task.lit(),
                                .antialiasing = setting.antialiasing};
    Participant& participant = participants.emplace_back();
    participant.compared_lit = task.lit();
    participant.cost = {rays ? "splatlas rays" : "splatlas", setting.name, threads};
    participant.draw = [ours, options, rays](Camera camera) {
      if (rays) {
        camera.projection = CameraProjection::kPerspective;
        camera.field_of_view_deg = kVerticalFovDeg;
      }
      return ours->renderer.render(camera, options, ours->latest);
    };
    participant.picture = [ours] { return ours->latest.picture; };
    participant.stats = [ours] { return &ours->latest.stats; };
  }
  const int turns = rays ? 1 : task.turns();
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<Camera> cameras,
                            cameras_by_axis(task.model.camera, turns, task.frames, *task.atlas));
  for (const Camera& camera : cameras) {
    for (const Participant& participant : std::span(participants).last(settings.size())) {
      SPLATLAS_RETURN_IF_ERROR(participant.draw(camera));
    }
  }
  return {};
}

Result<void> add_volpack(const ErrorTask& task, OpacityRounding rounding,
                         std::vector<Participant>& participants) {
  SPLATLAS_ASSIGN_OR_RETURN(
      VolpackPeer volpack,
      VolpackPeer::classify(task.model.volume, task.model.appearance, rounding,
                            task.lit() ? VolpackShading::kHybrid : VolpackShading::kUnlit));
  Participant& participant = participants.emplace_back();
  participant.compared_lit = task.lit();
  participant.cost = {"VolPack", rounding == OpacityRounding::kDown ? "classified" : "rounded"};
  participant.draw = [volpack, task](const Camera& camera) mutable -> Result<void> {
    SPLATLAS_ASSIGN_OR_RETURN(const ParallelView view, task.view(camera));
    return volpack.render(view);
  };
  participant.picture = [volpack] { return volpack.picture(); };
  return {};
}

Result<void> add_vtk(const ErrorTask& task, VtkVolumeMapper mapper, double step_mm,
                     std::vector<Participant>& participants) {
  VtkPeer vtk(task.size);
  vtk.add_volume(task.model.volume, task.model.appearance, mapper, step_mm);
  vtk.shade_volumes(task.lit());
  Participant& participant = participants.emplace_back();
  participant.cost = {mapper == VtkVolumeMapper::kGpu ? "VTK GPU" : "VTK FixedPoint",
                      fmt::format("step {}", step_mm), 2};
  participant.draw = [vtk, task](const Camera& camera) mutable -> Result<void> {
    SPLATLAS_ASSIGN_OR_RETURN(const ParallelView view, task.view(camera));
    vtk.render(PerspectiveView{view, kVerticalFovDeg});
    return {};
  };
  participant.picture = [vtk] { return vtk.picture(); };
  participant.compared_lit = false;
  if (task.lit()) {
    participant.draw_unlit = [vtk, task](const Camera& camera) mutable -> Result<void> {
      SPLATLAS_ASSIGN_OR_RETURN(const ParallelView view, task.view(camera));
      vtk.shade_volumes(false);
      vtk.render(PerspectiveView{view, kVerticalFovDeg});
      vtk.shade_volumes(true);
      return {};
    };
  }
  return participant.draw(task.camera(0));
}

namespace {

/// Adds the error of the latest picture. `rms` holds the mean square until the last view.
void add_error(const Participant& participant, const ReferencePicture& expected, int views_compared,
               PictureDifference& mean) {
  const PictureDifference d = difference(participant.picture(), expected);
  mean.rms += d.rms * d.rms / views_compared;
  mean.mean += d.mean / views_compared;
  mean.largest = std::max(mean.largest, d.largest);
  mean.pixels += d.pixels;
}

}  // namespace

Result<void> compare(std::vector<Participant>& participants, const ErrorTask& task,
                     Classification classification, int views_compared) {
  const auto truth_of = [&](const ParallelView& view, bool lit) {
    const Grid& grid = task.model.volume.grid;
    const reference::GreyTruth truth(task.model.volume, task.model.appearance, classification,
                                     lit ? &view : nullptr);
    return classification == Classification::kBefore
               ? render_grey_truth(truth, grid, view, 0)
               : render_grey_truth(truth, grid, PerspectiveView{view, kVerticalFovDeg}, 0);
  };
  for (Participant& participant : participants) participant.cost.error = {};
  for (int n = 0; n < views_compared; ++n) {
    const Camera camera = task.camera(2 * n);
    SPLATLAS_ASSIGN_OR_RETURN(const ParallelView view, task.view(camera));
    for (const bool lit : {true, false}) {
      std::optional<ReferencePicture> expected;
      for (Participant& participant : participants) {
        if (participant.compared_lit != lit) continue;
        if (!expected) expected = truth_of(view, lit);
        SPLATLAS_RETURN_IF_ERROR(participant.draw_unlit ? participant.draw_unlit(camera)
                                                        : participant.draw(camera));
        add_error(participant, *expected, views_compared, participant.cost.error);
      }
    }
  }
  for (Participant& participant : participants)
    participant.cost.error.rms = std::sqrt(participant.cost.error.rms);
  return {};
}

Result<std::vector<RendererCost>> take_times(std::vector<Participant> participants, const ErrorTask& task) {
  std::vector<Contender> contenders;
  for (const Participant& participant : participants) {
    contenders.emplace_back([&](int turn) -> Result<std::vector<Elapsed>> {
      const Camera camera = task.camera(turn);
      Stopwatch watch;
      SPLATLAS_RETURN_IF_ERROR(participant.draw(camera));
      const Elapsed frame = watch.lap();
      if (!participant.stats) return std::vector{frame};
      const RenderStats& stats = *participant.stats();
      return std::vector{frame, stats.traversal, stats.rasterize, stats.sheets, stats.resolve};
    });
  }
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<StageTimes> times,
                            measure_interleaved(contenders, task.turns()));
  std::vector<RendererCost> costs;
  for (std::size_t n = 0; n < participants.size(); ++n) {
    RendererCost& cost = costs.emplace_back(std::move(participants[n].cost));
    cost.frame = median(times[n][0]);
    if (times[n].size() == 1) continue;
    cost.traversal = median(times[n][1]);
    cost.rasterize = median(times[n][2]);
    cost.sheets = median(times[n][3]);
    cost.resolve = median(times[n][4]);
  }
  return costs;
}

}  // namespace splatlas

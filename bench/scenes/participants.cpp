#include "bench/scenes/participants.h"

#include <array>
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
                                .antialiasing = setting.antialiasing};
    Participant& participant = participants.emplace_back();
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

Result<void> add_volpack(const ErrorTask& task, std::vector<Participant>& participants) {
  SPLATLAS_ASSIGN_OR_RETURN(VolpackPeer volpack,
                            VolpackPeer::classify(task.model.volume, task.model.appearance));
  Participant& participant = participants.emplace_back();
  participant.cost = {"VolPack", "classified"};
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
  vtk.shade_volumes(true);
  Participant& participant = participants.emplace_back();
  participant.cost = {mapper == VtkVolumeMapper::kGpu ? "VTK GPU" : "VTK FixedPoint",
                      fmt::format("step {}", step_mm), 2};
  participant.draw = [vtk, task](const Camera& camera) mutable -> Result<void> {
    SPLATLAS_ASSIGN_OR_RETURN(const ParallelView view, task.view(camera));
    vtk.render(PerspectiveView{view, kVerticalFovDeg});
    return {};
  };
  participant.picture = [vtk] { return vtk.picture(); };
  participant.draw_unlit = [vtk, task](const Camera& camera) mutable -> Result<void> {
    SPLATLAS_ASSIGN_OR_RETURN(const ParallelView view, task.view(camera));
    vtk.shade_volumes(false);
    vtk.render(PerspectiveView{view, kVerticalFovDeg});
    vtk.shade_volumes(true);
    return {};
  };
  return participant.draw(task.camera(0));
}

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
  for (int n = 0; n < views_compared; ++n) {
    const Camera camera = task.camera(2 * n);
    SPLATLAS_ASSIGN_OR_RETURN(const ParallelView view, task.view(camera));
    std::array<std::optional<ReferencePicture>, 2> truths;  // unlit, lit
    for (Participant& participant : participants) {
      const bool lit = participant.draw_unlit == nullptr;
      if (!truths[lit ? 1 : 0]) truths[lit ? 1 : 0] = truth_of(view, lit);
      SPLATLAS_RETURN_IF_ERROR(lit ? participant.draw(camera) : participant.draw_unlit(camera));
      const PictureDifference d = difference(participant.picture(), *truths[lit ? 1 : 0]);
      PictureDifference& error = participant.cost.error;
      error.rms = std::sqrt(error.rms * error.rms + d.rms * d.rms / views_compared);
      error.mean += d.mean / views_compared;
    }
  }
  return {};
}

Result<std::vector<RendererCost>> take_times(std::vector<Participant> participants, const ErrorTask& task) {
  std::vector<Contender> contenders;
  for (const Participant& participant : participants)
    contenders.push_back(timed([&](int turn) { return participant.draw(task.camera(turn)); }));
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<StageTimes> times,
                            measure_interleaved(contenders, task.turns()));
  std::vector<RendererCost> costs;
  for (std::size_t n = 0; n < participants.size(); ++n) {
    costs.push_back(std::move(participants[n].cost));
    costs.back().frame = median(times[n][0]);
  }
  return costs;
}

}  // namespace splatlas

#include "bench/error_participants.h"

#include <set>
#include <utility>

#include <fmt/format.h>

#include "bench/frames.h"
#include "format/system/result_macros.h"
#include "player/view/shear.h"

namespace splatlas {
namespace {

RendererCost named(std::string renderer, std::string setting, unsigned threads) {
  RendererCost cost;
  cost.renderer = std::move(renderer);
  cost.setting = std::move(setting);
  cost.threads = threads;
  return cost;
}

/// A renderer of ours with its latest picture.
struct Ours {
  Renderer renderer;
  RenderOptions options;
  Picture latest;

  Result<void> draw(const Camera& camera, Quality quality) {
    options.quality = quality;
    return renderer.render(camera, options, latest);
  }
};

void add_settings(const char* name, unsigned threads, const std::shared_ptr<Ours>& ours,
                  std::vector<Participant>& participants) {
  for (const NamedQuality& setting : kQualities) {
    Participant participant;
    participant.cost = named(name, setting.name, threads);
    participant.draw = [ours, &setting](const Camera& camera) { return ours->draw(camera, setting.quality); };
    participant.picture = [ours] { return ours->latest; };
    participant.stats = [ours] { return &ours->renderer.stats(); };
    participants.push_back(std::move(participant));
  }
}

Camera in_perspective(Camera camera) {
  camera.projection = CameraProjection::kPerspective;
  camera.field_of_view_deg = kVerticalFovDeg;
  return camera;
}

}  // namespace

Result<reference::PerspectiveView> perspective_view(const Camera& camera, const ErrorTask& task) {
  SPLATLAS_ASSIGN_OR_RETURN(const ParallelView view, parallel_view(camera, task.size, task.atlas->display()));
  return reference::PerspectiveView{view, kVerticalFovDeg};
}

Result<void> add_ours(const ErrorTask& task, unsigned threads, std::vector<Participant>& participants) {
  RenderOptions options;
  options.size = task.size;
  options.hybrid_shading = false;
  const auto ours = std::make_shared<Ours>(Ours{Renderer(task.atlas, {.threads = threads}), options, {}});
  SPLATLAS_RETURN_IF_ERROR(ours->renderer.select(task.model.selection));
  std::set<Axis> prepared;
  for (int turn = 0; turn < task.turns(); ++turn) {
    const Camera camera = task.camera(turn);
    SPLATLAS_ASSIGN_OR_RETURN(const ParallelView view,
                              parallel_view(camera, task.size, task.atlas->display()));
    if (!prepared.insert(factorise(view, task.atlas->grid()).principal).second) continue;
    for (const NamedQuality& setting : kQualities)
      SPLATLAS_RETURN_IF_ERROR(ours->draw(camera, setting.quality));
  }
  add_settings("splatlas", threads, ours, participants);
  return {};
}

Result<void> add_our_rays(const ErrorTask& task, unsigned threads, std::vector<Participant>& participants) {
  RenderOptions options;
  options.size = task.size;
  options.hybrid_shading = false;
  options.classification = Classification::kAfter;
  const auto ours = std::make_shared<Ours>(Ours{Renderer(task.atlas, {.threads = threads}), options, {}});
  SPLATLAS_RETURN_IF_ERROR(ours->renderer.select(task.model.selection));
  for (const NamedQuality& setting : kQualities) {
    SPLATLAS_RETURN_IF_ERROR(ours->draw(in_perspective(task.camera(0)), setting.quality));
  }
  add_settings("splatlas rays", threads, ours, participants);
  for (auto ours_at = participants.end() - kQualities.size(); ours_at != participants.end(); ++ours_at) {
    ours_at->draw = [draw = ours_at->draw](const Camera& camera) { return draw(in_perspective(camera)); };
  }
  return {};
}

Result<Participant> volpack_participant(const ErrorTask& task, OpacityRounding rounding) {
  SPLATLAS_ASSIGN_OR_RETURN(VolpackPeer classified,
                            VolpackPeer::classify(task.model.volume, task.model.appearance, rounding));
  const auto volpack = std::make_shared<VolpackPeer>(std::move(classified));
  Participant participant;
  participant.cost = named("VolPack", rounding == OpacityRounding::kDown ? "classified" : "rounded", 1);
  participant.draw = [volpack, task](const Camera& camera) -> Result<void> {
    SPLATLAS_ASSIGN_OR_RETURN(const ParallelView view,
                              parallel_view(camera, task.size, task.atlas->display()));
    return volpack->render(view);
  };
  participant.picture = [volpack] { return volpack->picture(); };
  return participant;
}

Result<Participant> vtk_participant(const ErrorTask& task, VtkVolumeMapper mapper, double step_mm) {
  const auto vtk = std::make_shared<VtkPeer>(task.size);
  vtk->add_volume(task.model.volume, task.model.appearance, mapper, step_mm);
  Participant participant;
  participant.cost = named(mapper == VtkVolumeMapper::kGpu ? "VTK GPU" : "VTK FixedPoint",
                           fmt::format("step {}", step_mm), 2);
  participant.draw = [vtk, task](const Camera& camera) -> Result<void> {
    SPLATLAS_ASSIGN_OR_RETURN(const reference::PerspectiveView view, perspective_view(camera, task));
    vtk->render(view);
    return {};
  };
  participant.picture = [vtk] { return vtk->picture(); };
  SPLATLAS_RETURN_IF_ERROR(participant.draw(task.camera(0)));
  return participant;
}

}  // namespace splatlas

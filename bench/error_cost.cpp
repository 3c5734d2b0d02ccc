#include "bench/error_cost.h"

#include <cmath>
#include <functional>
#include <utility>

#include "bench/measure.h"
#include "format/system/result_macros.h"
#include "tests/reference/grey_truth.h"

namespace splatlas {
namespace {

using reference::GreyTruth;
using reference::PictureDifference;
using reference::ReferencePicture;

using TruthOf = std::function<Result<ReferencePicture>(const Camera& camera)>;

/// Accumulates differences of several views.
class ErrorSum {
 public:
  void add(const PictureDifference& d) {
    squares_ += d.rms * d.rms;
    sum_.mean += d.mean;
    if (d.largest > sum_.largest) {
      sum_.largest = d.largest;
      sum_.column = d.column;
      sum_.row = d.row;
    }
    sum_.pixels += d.pixels;
    ++views_;
  }
  [[nodiscard]] PictureDifference mean() const {
    PictureDifference mean = sum_;
    mean.rms = std::sqrt(squares_ / views_);
    mean.mean /= views_;
    return mean;
  }

 private:
  double squares_ = 0;
  PictureDifference sum_;
  int views_ = 0;
};

Result<void> compare(std::vector<Participant>& participants, const ErrorTask& task, const TruthOf& truth_of,
                     int views_compared) {
  std::vector<ErrorSum> errors(participants.size());
  for (int view = 0; view < views_compared; ++view) {
    const Camera camera = task.camera(2 * view);
    SPLATLAS_ASSIGN_OR_RETURN(const ReferencePicture truth, truth_of(camera));
    for (std::size_t n = 0; n < participants.size(); ++n) {
      SPLATLAS_RETURN_IF_ERROR(participants[n].draw(camera));
      errors[n].add(difference(participants[n].picture(), truth));
    }
  }
  for (std::size_t n = 0; n < participants.size(); ++n) participants[n].cost.error = errors[n].mean();
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
      return std::vector{frame, stats.traversal, stats.sheets, stats.resolve};
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
    cost.sheets = median(times[n][2]);
    cost.resolve = median(times[n][3]);
  }
  return costs;
}

}  // namespace

Result<void> compare_parallel(std::vector<Participant>& participants, const ErrorTask& task,
                              int views_compared) {
  const GreyTruth truth(task.model.volume, task.model.appearance, Classification::kBefore);
  const auto truth_of = [&](const Camera& camera) -> Result<ReferencePicture> {
    SPLATLAS_ASSIGN_OR_RETURN(const ParallelView view,
                              parallel_view(camera, task.size, task.atlas->display()));
    return render_grey_truth(truth, task.model.volume.grid, view, 0);
  };
  return compare(participants, task, truth_of, views_compared);
}

Result<std::vector<RendererCost>> measure_parallel(const ErrorTask& task, int views_compared) {
  std::vector<Participant> participants;
  SPLATLAS_RETURN_IF_ERROR(add_ours(task, 1, participants));
  SPLATLAS_RETURN_IF_ERROR(add_ours(task, 2, participants));
  for (const OpacityRounding rounding : {OpacityRounding::kDown, OpacityRounding::kNearest}) {
    SPLATLAS_ASSIGN_OR_RETURN(Participant volpack, volpack_participant(task, rounding));
    participants.push_back(std::move(volpack));
  }
  SPLATLAS_RETURN_IF_ERROR(compare_parallel(participants, task, views_compared));
  return take_times(std::move(participants), task);
}

Result<std::vector<RendererCost>> measure_perspective(const ErrorTask& task, const VtkSteps& steps,
                                                      int views_compared) {
  std::vector<Participant> participants;
  SPLATLAS_RETURN_IF_ERROR(add_our_rays(task, 1, participants));
  SPLATLAS_RETURN_IF_ERROR(add_our_rays(task, 2, participants));
  const auto add_vtk = [&](VtkVolumeMapper mapper, double step_mm) -> Result<void> {
    SPLATLAS_ASSIGN_OR_RETURN(Participant vtk, vtk_participant(task, mapper, step_mm));
    participants.push_back(std::move(vtk));
    return {};
  };
  for (const double step_mm : steps.fixed_point_mm) {
    SPLATLAS_RETURN_IF_ERROR(add_vtk(VtkVolumeMapper::kFixedPoint, step_mm));
  }
  for (const double step_mm : steps.gpu_mm) SPLATLAS_RETURN_IF_ERROR(add_vtk(VtkVolumeMapper::kGpu, step_mm));
  const GreyTruth truth(task.model.volume, task.model.appearance, Classification::kAfter);
  const auto truth_of = [&](const Camera& camera) -> Result<ReferencePicture> {
    SPLATLAS_ASSIGN_OR_RETURN(const reference::PerspectiveView view, perspective_view(camera, task));
    return render_grey_truth(truth, task.model.volume.grid, view, 0);
  };
  SPLATLAS_RETURN_IF_ERROR(compare(participants, task, truth_of, views_compared));
  return take_times(std::move(participants), task);
}

}  // namespace splatlas

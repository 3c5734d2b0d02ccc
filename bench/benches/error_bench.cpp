// Bench `error`: run time against error at every quality, beside the peers.
#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "bench/bench.h"
#include "bench/peers/x_server.h"
#include "bench/scenes/atlases.h"
#include "bench/scenes/error_plot.h"
#include "bench/scenes/participants.h"
#include "format/result_macros.h"

namespace splatlas {
namespace {

/// Sample distances of both VTK mappers.
struct VtkSteps {
  std::vector<double> fixed_point_mm, gpu_mm;
};

struct Effort {
  std::vector<int> sizes{512, 1024};
  int frames = 7;
  int repeats = 2;                                        // at the smallest size; 1 at others
  int views_compared = 2;                                 // likewise
  VtkSteps all_steps{{2, 1, 0.5, 0.25}, {1, 0.5, 0.25}};  // likewise
  VtkSteps quoted_steps{{1}, {0.5}};                      // peers of our accurate mode
};

Effort quick_effort() {
  Effort effort{.sizes = {512}, .frames = 3, .repeats = 1, .views_compared = 1};
  effort.all_steps = effort.quoted_steps;
  return effort;
}

/// Parallel projection, pre-classified: Splatlas with one and two threads, and VolPack. Or perspective
/// projection, post-classified: Splatlas, and VTK at these steps.
Result<std::vector<RendererCost>> measure(const ErrorTask& task, Classification classification,
                                          const VtkSteps& steps, int views_compared) {
  std::vector<Participant> participants;
  for (const unsigned threads : {1u, 2u})
    SPLATLAS_RETURN_IF_ERROR(add_ours(task, classification, threads, participants));
  if (classification == Classification::kBefore) {
    for (const OpacityRounding rounding : {OpacityRounding::kDown, OpacityRounding::kNearest})
      SPLATLAS_RETURN_IF_ERROR(add_volpack(task, rounding, participants));
  } else {
    for (const double step_mm : steps.fixed_point_mm)
      SPLATLAS_RETURN_IF_ERROR(add_vtk(task, VtkVolumeMapper::kFixedPoint, step_mm, participants));
    for (const double step_mm : steps.gpu_mm)
      SPLATLAS_RETURN_IF_ERROR(add_vtk(task, VtkVolumeMapper::kGpu, step_mm, participants));
  }
  SPLATLAS_RETURN_IF_ERROR(compare(participants, task, classification, views_compared));
  return take_times(std::move(participants), task);
}

const RendererCost& cost_of(const std::vector<RendererCost>& costs, const std::string& renderer,
                            const std::string& setting, unsigned threads) {
  return *std::find_if(costs.begin(), costs.end(), [&](const RendererCost& cost) {
    return cost.renderer == renderer && cost.setting == setting && cost.threads == threads;
  });
}

/// Draft: wall clock with two threads, CPU time with one, as VolPack has one.
void summarise_parallel(const std::vector<RendererCost>& costs, const std::string& appearance,
                        nlohmann::ordered_json& summary) {
  const RendererCost& volpack = cost_of(costs, "VolPack", "classified", 1);
  const RendererCost& rounded = cost_of(costs, "VolPack", "rounded", 1);
  const RendererCost& one = cost_of(costs, "splatlas", "draft", 1);
  const RendererCost& two = cost_of(costs, "splatlas", "draft", 2);
  raise(summary, "fast_vs_volpack_wall_max", two.frame.wall_ms / volpack.frame.wall_ms);
  raise(summary, "fast_vs_volpack_cpu_max", one.frame.cpu_ms / volpack.frame.cpu_ms);
  raise(summary, fmt::format("fast_rmse_vs_volpack_{}_max", appearance), one.error.rms / volpack.error.rms);
  raise(summary, fmt::format("fast_rmse_vs_rounded_volpack_{}_max", appearance),
        one.error.rms / rounded.error.rms);
}

/// Normal quality with two threads, as VTK has; 512x512 only.
void summarise_perspective(const std::vector<RendererCost>& costs, const std::string& scene,
                           nlohmann::ordered_json& summary) {
  const RendererCost& ours = cost_of(costs, "splatlas rays", "normal", 2);
  const RendererCost& fixed_point = cost_of(costs, "VTK FixedPoint", "step 1", 2);
  const RendererCost& gpu = cost_of(costs, "VTK GPU", "step 0.5", 2);
  raise(summary, "accurate_rmse_max", 255 * ours.error.rms);
  if (scene == "left" || scene == "head") {
    raise(summary, "accurate_vs_fixedpoint_" + scene, ours.frame.wall_ms / fixed_point.frame.wall_ms);
  }
  raise(summary, "accurate_vs_vtkgpu_max", ours.frame.wall_ms / gpu.frame.wall_ms);
}

/// Ratios are relative to `unit`.
void add_rows(const ErrorScene& scene, int size, const ErrorAppearance& appearance,
              const std::vector<RendererCost>& costs, const RendererCost& unit, Table& table) {
  for (const RendererCost& cost : costs) {
    table.rows.push_back({{"scene", scene.name},
                          {"size", size},
                          {"transfer", appearance.name},
                          {"renderer", cost.renderer},
                          {"setting", cost.setting},
                          {"threads", cost.threads},
                          {"wall_ms", cost.frame.wall_ms},
                          {"cpu_ms", cost.frame.cpu_ms},
                          {"wall_ratio", cost.frame.wall_ms / unit.frame.wall_ms},
                          {"cpu_ratio", cost.frame.cpu_ms / unit.frame.cpu_ms},
                          {"rmse", 255 * cost.error.rms},
                          {"largest", 255 * cost.error.largest},
                          {"mean", 255 * cost.error.mean},
                          {"rmse_ratio", cost.error.rms / unit.error.rms}});
    if (cost.sheets.wall_ms == 0) continue;
    table.rows.back().update({{"traversal_cpu", cost.traversal.cpu_ms},
                              {"sheets_cpu", cost.sheets.cpu_ms},
                              {"resolve_cpu", cost.resolve.cpu_ms}});
  }
}

}  // namespace

Result<Report> run_error_bench(const BenchOptions& options) {
  Report report;
  SPLATLAS_ASSIGN_OR_RETURN(const XServer display, start_x_server());
  SPLATLAS_ASSIGN_OR_RETURN(const std::shared_ptr<const Atlas> atlas, open_colin27(options));
  SPLATLAS_ASSIGN_OR_RETURN(const AtlasContent content, atlas->read_all());
  const Effort effort = options.quick ? quick_effort() : Effort{};
  Table parallel{"parallel",
                 "Time and error, parallel projection, pre-classified",
                 {"wall_ratio, cpu_ratio, rmse_ratio: against VolPack, which has one thread",
                  "both with hybrid shading, our default: VolPack by a shade table of the same normals",
                  "rmse, largest, mean: against ground truth in double precision, in 1/255, linear RGBA",
                  "VolPack rounded: opacities rounded to the nearest 255th, as VolPack itself rounds down"}};
  Table perspective{
      "perspective",
      "Time and error, perspective projection, post-classified",
      {"wall_ratio, cpu_ratio, rmse_ratio: against VTK FixedPoint at a step of 1 mm",
       "with shading: ours hybrid, VTK's by gradients; VTK's errors are those of unlit pictures",
       "VTK pictures have 8 bits, which costs an error of 0.29 alone"}};
  for (const ErrorScene& scene : error_scenes()) {
    for (const ErrorAppearance& appearance : error_appearances()) {
      SPLATLAS_ASSIGN_OR_RETURN(const ErrorModel model, error_model(content, scene, appearance));
      for (const int size : effort.sizes) {
        options.tell(fmt::format("{}, {}, {}x{}", scene.name, appearance.name, size, size));
        const bool smallest = size == effort.sizes.front();
        const ErrorTask task{atlas, model, {size, size}, effort.frames, smallest ? effort.repeats : 1};
        const int views = smallest ? effort.views_compared : 1;
        const VtkSteps& steps = smallest ? effort.all_steps : effort.quoted_steps;
        SPLATLAS_ASSIGN_OR_RETURN(const std::vector<RendererCost> fast,
                                  measure(task, Classification::kBefore, steps, views));
        add_rows(scene, size, appearance, fast, cost_of(fast, "VolPack", "classified", 1), parallel);
        summarise_parallel(fast, appearance.name, report.summary);
        SPLATLAS_ASSIGN_OR_RETURN(const std::vector<RendererCost> accurate,
                                  measure(task, Classification::kAfter, steps, views));
        add_rows(scene, size, appearance, accurate, cost_of(accurate, "VTK FixedPoint", "step 1", 2),
                 perspective);
        if (smallest) summarise_perspective(accurate, scene.name, report.summary);
      }
    }
  }
  report.tables = {std::move(parallel), std::move(perspective)};
  if (!options.plot.empty()) SPLATLAS_RETURN_IF_ERROR(write_error_plot(report.tables, options.plot));
  return report;
}

}  // namespace splatlas

// Bench `error`: run time against error at every quality, beside the peers.
#include <algorithm>
#include <cstdio>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "bench/bench.h"
#include "bench/scenes/atlases.h"
#include "bench/scenes/participants.h"
#include "format/result_macros.h"

namespace splatlas {
namespace {

/// Sample distances of both VTK mappers.
struct VtkSteps {
  std::vector<double> fixed_point_mm, gpu_mm;
};

struct Effort {
  std::vector<int> sizes{512, 1024};  // perspective: 512 only
  int frames = 7, repeats = 2;        // repeats: of 512
  int views_compared = 2;
  VtkSteps steps{{2, 1, 0.5, 0.25}, {1, 0.5, 0.25}};
};

/// Parallel projection, pre-classified: Splatlas with one and two threads, and VolPack. Or perspective
/// projection, post-classified: Splatlas, and VTK at these steps.
Result<std::vector<RendererCost>> measure(const ErrorTask& task, Classification classification,
                                          const Effort& effort) {
  std::vector<Participant> participants;
  for (const unsigned threads : {1u, 2u})
    SPLATLAS_RETURN_IF_ERROR(add_ours(task, classification, threads, participants));
  if (classification == Classification::kBefore) {
    SPLATLAS_RETURN_IF_ERROR(add_volpack(task, participants));
  } else {
    for (const double step_mm : effort.steps.fixed_point_mm)
      SPLATLAS_RETURN_IF_ERROR(add_vtk(task, VtkVolumeMapper::kFixedPoint, step_mm, participants));
    for (const double step_mm : effort.steps.gpu_mm)
      SPLATLAS_RETURN_IF_ERROR(add_vtk(task, VtkVolumeMapper::kGpu, step_mm, participants));
  }
  SPLATLAS_RETURN_IF_ERROR(compare(participants, task, classification, effort.views_compared));
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
  const RendererCost& one = cost_of(costs, "splatlas", "draft", 1);
  const RendererCost& two = cost_of(costs, "splatlas", "draft", 2);
  raise(summary, "fast_vs_volpack_wall_max", two.frame.wall_ms / volpack.frame.wall_ms);
  raise(summary, "fast_vs_volpack_cpu_max", one.frame.cpu_ms / volpack.frame.cpu_ms);
  raise(summary, fmt::format("fast_rmse_vs_volpack_{}_max", appearance), one.error.rms / volpack.error.rms);
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
                          {"mean", 255 * cost.error.mean},
                          {"rmse_ratio", cost.error.rms / unit.error.rms}});
  }
}

/// The distinct cells of a column, in order of first occurrence.
std::vector<std::string> values_of(std::span<const Row> rows, const char* column) {
  std::vector<std::string> values;
  for (const Row& row : rows) {
    if (const auto value = row[column].get<std::string>(); std::ranges::find(values, value) == values.end())
      values.push_back(value);
  }
  return values;
}

/// Rows of the smallest size; ours with two threads.
std::vector<Row> plotted_rows(std::span<const Table> tables) {
  std::vector<Row> rows;
  for (const Table& table : tables) {
    for (const Row& row : table.rows) {
      const bool is_ours = row["renderer"].get<std::string>().starts_with("splatlas");
      if (row["size"] == 512 && !(is_ours && row["threads"] == 1)) rows.push_back(row);
    }
  }
  return rows;
}

/// One panel: a curve per renderer through its settings, the fastest first.
std::string panel(std::span<const Row> rows, const std::string& scene, const std::string& transfer) {
  std::string data, curves;
  int color = 0;
  for (const std::string& renderer : values_of(rows, "renderer")) {
    std::string points;
    for (const Row& row : rows) {
      if (row["scene"] == scene && row["transfer"] == transfer && row["renderer"] == renderer)
        points += fmt::format("{} {}\n", row["wall_ms"].dump(), row["rmse"].dump());
    }
    ++color;
    if (points.empty()) continue;
    data += fmt::format("$curve{} << EOD\n{}EOD\n", color, points);
    curves += fmt::format("{}$curve{} with linespoints lw 2 pt 7 lc {} title '{}'",
                          curves.empty() ? "" : ", ", color, color, renderer);
  }
  return fmt::format("{}set title '{}, {}, 512x512'\nplot {}\n", data, scene, transfer, curves);
}

/// Draws the tables by gnuplot: one panel per scene (columns) and transfer function (rows), with logarithmic
/// axes; one curve per renderer through its settings.
Result<void> write_error_plot(std::span<const Table> tables, const std::filesystem::path& png) {
  std::vector<Row> rows = plotted_rows(tables);
  const std::vector<std::string> scenes = values_of(rows, "scene"), transfers = values_of(rows, "transfer");
  std::ranges::sort(rows, {}, [](const Row& row) { return row["wall_ms"].get<double>(); });
  std::string script = fmt::format(
      "set terminal pngcairo size {},{} noenhanced font 'DejaVu Sans,10'\n"
      "set output '{}'\n"
      "set logscale xy\nset grid\nset xlabel 'wall clock, ms'\nset ylabel 'RMS error, 1/255'\n"
      "set key below maxrows 2 font ',8'\nset multiplot layout {},{}\n",
      380 * scenes.size(), 320 * transfers.size(), png.string(), transfers.size(), scenes.size());
  for (const std::string& transfer : transfers) {
    for (const std::string& scene : scenes) script += panel(rows, scene, transfer);
  }
  FILE* gnuplot = popen("gnuplot", "w");
  const bool written =
      gnuplot != nullptr && std::fwrite(script.data(), 1, script.size(), gnuplot) == script.size();
  if (gnuplot != nullptr && pclose(gnuplot) == 0 && written) return {};
  return fail(ErrorCode::kFailed,
              fmt::format("{}: gnuplot (Debian's package gnuplot-nox) cannot draw it", png.string()));
}

}  // namespace

Result<Report> run_error_bench(const BenchOptions& options) {
  Report report;
  SPLATLAS_ASSIGN_OR_RETURN(const XServer display, start_x_server());
  SPLATLAS_ASSIGN_OR_RETURN(const std::shared_ptr<const Atlas> atlas, open_colin27(options));
  SPLATLAS_ASSIGN_OR_RETURN(const AtlasContent content, atlas->read_all());
  const Effort effort = options.quick ? Effort{{512}, 3, 1, 1, {{1}, {0.5}}} : Effort{};
  Table parallel{"parallel",
                 "Time and error, parallel projection, pre-classified",
                 {"wall_ratio, cpu_ratio, rmse_ratio: against VolPack, which has one thread",
                  "both with hybrid shading, our default: VolPack by a shade table of the same normals",
                  "rmse, mean: against ground truth in double precision, in 1/255, linear RGBA"}};
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
        SPLATLAS_ASSIGN_OR_RETURN(const std::vector<RendererCost> fast,
                                  measure(task, Classification::kBefore, effort));
        add_rows(scene, size, appearance, fast, cost_of(fast, "VolPack", "classified", 1), parallel);
        summarise_parallel(fast, appearance.name, report.summary);
        if (!smallest) continue;
        SPLATLAS_ASSIGN_OR_RETURN(const std::vector<RendererCost> accurate,
                                  measure(task, Classification::kAfter, effort));
        add_rows(scene, size, appearance, accurate, cost_of(accurate, "VTK FixedPoint", "step 1", 2),
                 perspective);
        summarise_perspective(accurate, scene.name, report.summary);
      }
    }
  }
  report.tables = {std::move(parallel), std::move(perspective)};
  if (!options.plot.empty()) SPLATLAS_RETURN_IF_ERROR(write_error_plot(report.tables, options.plot));
  return report;
}

}  // namespace splatlas

// Time against error: ours at every quality beside the peers, in every scene.
#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "bench/atlases.h"
#include "bench/bench.h"
#include "bench/error_cost.h"

namespace splatlas {
namespace {

const RendererCost& cost_of(const std::vector<RendererCost>& costs, const std::string& renderer,
                            const std::string& setting, unsigned threads) {
  return *std::find_if(costs.begin(), costs.end(), [&](const RendererCost& cost) {
    return cost.renderer == renderer && cost.setting == setting && cost.threads == threads;
  });
}

void raise(nlohmann::ordered_json& summary, const std::string& key, double value) {
  if (!summary.contains(key) || summary[key].get<double>() < value) summary[key] = value;
}

/// Draft with two threads by the wall clock, with one in CPU time: VolPack has one.
void summarise(const std::vector<RendererCost>& costs, const std::string& look,
               nlohmann::ordered_json& summary) {
  const RendererCost& volpack = cost_of(costs, "VolPack", "classified", 1);
  const RendererCost& rounded = cost_of(costs, "VolPack", "rounded", 1);
  const RendererCost& one = cost_of(costs, "splatlas", "draft", 1);
  const RendererCost& two = cost_of(costs, "splatlas", "draft", 2);
  raise(summary, "fast_vs_volpack_wall_max", two.frame.wall_ms / volpack.frame.wall_ms);
  raise(summary, "fast_vs_volpack_cpu_max", one.frame.cpu_ms / volpack.frame.cpu_ms);
  raise(summary, fmt::format("fast_rmse_vs_volpack_{}_max", look), one.error.rms / volpack.error.rms);
  raise(summary, fmt::format("fast_rmse_vs_rounded_volpack_{}_max", look), one.error.rms / rounded.error.rms);
}

void add_rows(const ErrorScene& scene, int size, const ErrorLook& look,
              const std::vector<RendererCost>& costs, Table& table) {
  const RendererCost& volpack = cost_of(costs, "VolPack", "classified", 1);
  for (const RendererCost& cost : costs) {
    table.rows.push_back({{"scene", scene.name},
                          {"size", size},
                          {"look", look.name},
                          {"renderer", cost.renderer},
                          {"setting", cost.setting},
                          {"threads", cost.threads},
                          {"wall_ms", cost.frame.wall_ms},
                          {"cpu_ms", cost.frame.cpu_ms},
                          {"wall_ratio", cost.frame.wall_ms / volpack.frame.wall_ms},
                          {"cpu_ratio", cost.frame.cpu_ms / volpack.frame.cpu_ms},
                          {"rmse", 255 * cost.error.rms},
                          {"largest", 255 * cost.error.largest},
                          {"mean", 255 * cost.error.mean},
                          {"rmse_ratio", cost.error.rms / volpack.error.rms}});
  }
}

}  // namespace

Result<Report> run_error_bench(const BenchOptions& options) {
  Report report;
  SPLATLAS_ASSIGN_OR_RETURN(const std::shared_ptr<const Atlas> atlas, open_colin27(options));
  SPLATLAS_ASSIGN_OR_RETURN(const AtlasContent content, atlas->read_all());
  const ErrorEffort effort =
      options.quick ? ErrorEffort{.frames = 3, .repeats = 1, .views_compared = 1} : ErrorEffort{};
  const std::vector<int> sizes = options.quick ? std::vector{512} : std::vector{512, 1024};
  Table table{
      "parallel", "Time and error, parallel projection, grey values classified before interpolation", {}, {}};
  for (const ErrorScene& scene : error_scenes()) {
    for (const ErrorLook& look : error_looks()) {
      SPLATLAS_ASSIGN_OR_RETURN(const ErrorModel model, error_model(content, scene, look));
      for (const int size : sizes) {
        options.tell(fmt::format("{}, {}, {}x{}", scene.name, look.name, size, size));
        SPLATLAS_ASSIGN_OR_RETURN(const std::vector<RendererCost> costs,
                                  measure_parallel(atlas, model, size, effort));
        add_rows(scene, size, look, costs, table);
        summarise(costs, look.name, report.summary);
      }
    }
  }
  table.notes = {
      "VolPack rounded: opacities handed over as the 255ths nearest to them, for VolPack itself rounds down",
      "wall_ratio, cpu_ratio, rmse_ratio: against VolPack, which has one thread",
      "rmse, largest, mean: against the truth in double precision, in 1/255 of linear light, all "
      "four channels"};
  report.tables.push_back(std::move(table));
  return report;
}

}  // namespace splatlas

// Bench `limit`: distance of the renderer from the limit of the machine.
#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "bench/atlases.h"
#include "bench/bench.h"
#include "bench/error_participants.h"
#include "bench/limit_task.h"
#include "bench/measure.h"
#include "format/system/result_macros.h"

namespace splatlas {
namespace {

struct Effort {
  std::vector<int> sizes{512, 1024};
  int frames = 7, repeats = 3;
  int thread_repeats = 12;

  [[nodiscard]] int turns() const { return frames * repeats; }
};

/// White volumes have one colour to composite, coloured ones three.
constexpr std::array kAppearances{ErrorAppearance{"thin", "profile=thin,opacity=0.01,color=#ffffff"},
                                  ErrorAppearance{"soft", "opacity=0.3,color=#ffffff"},
                                  ErrorAppearance{"thin, coloured", "profile=thin,opacity=0.01"}};

/// Cost of a scene: minimum over repeats of each frame, median over frames.
struct LimitCost {
  Elapsed frame, rasterize, sheets, resolve, packed, dense;
  double dense_ns = 0;     ///< per sample
  double over_packed = 0;  ///< sheets over those of packed voxels
  Elapsed one, two;        ///< frames of one and two threads
  double two_thread_speedup = 0;
};

Result<LimitCost> measure(LimitTask& task, const Effort& effort) {
  SPLATLAS_RETURN_IF_ERROR(task.prepare(effort.turns()));
  std::vector<Contender> contenders{[&](int turn) { return task.draw(turn); },
                                    [&](int turn) { return task.draw_packed(turn); },
                                    [&](int turn) { return task.draw_dense(turn); }};
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<StageTimes> times,
                            measure_interleaved(contenders, effort.turns()));
  const auto best = [&](std::size_t contender, std::size_t stage) {
    return best_of_repeats(times[contender][stage], effort.frames);
  };
  LimitCost cost;
  cost.frame = median(best(0, 0));
  cost.rasterize = median(best(0, 1));
  cost.sheets = median(best(0, 2));
  cost.resolve = median(best(0, 3));
  cost.packed = median(best(1, 0));
  cost.dense = median(best(2, 0));
  std::vector<double> dense_ns, over_packed;
  const auto sheets = best(0, 2), packed = best(1, 0), dense = best(2, 0);
  for (int frame = 0; frame < effort.frames; ++frame) {
    const auto n = static_cast<std::size_t>(frame);
    SPLATLAS_ASSIGN_OR_RETURN(const std::uint64_t dense_samples, task.dense_samples(frame));
    dense_ns.push_back(1e6 * dense[n].cpu_ms / static_cast<double>(dense_samples));
    over_packed.push_back(sheets[n].cpu_ms / packed[n].cpu_ms);
  }
  cost.dense_ns = median(dense_ns);
  cost.over_packed = median(over_packed);
  return cost;
}

/// Speedup of two threads by the wall clock. Other load takes a core from the second thread: many more
/// repeats.
Result<void> measure_threads(const ErrorTask& task, int repeats, LimitCost& cost) {
  std::vector<Participant> participants;
  for (const unsigned threads : {1u, 2u}) SPLATLAS_RETURN_IF_ERROR(add_ours(task, threads, participants));
  std::vector<Contender> contenders;
  for (const Participant& participant : participants) {
    if (participant.cost.setting != "normal") continue;
    contenders.emplace_back([&](int turn) -> Result<std::vector<Elapsed>> {
      Stopwatch watch;
      SPLATLAS_RETURN_IF_ERROR(participant.draw(task.camera(turn)));
      return std::vector{watch.lap()};
    });
  }
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<StageTimes> times,
                            measure_interleaved(contenders, task.frames * repeats));
  const auto one = best_of_repeats(times[0][0], task.frames);
  const auto two = best_of_repeats(times[1][0], task.frames);
  std::vector<double> speedups;
  for (std::size_t n = 0; n < one.size(); ++n) speedups.push_back(one[n].wall_ms / two[n].wall_ms);
  cost.one = median(one);
  cost.two = median(two);
  cost.two_thread_speedup = median(speedups);
  return {};
}

Row row_of(const LimitTask& task, const LimitCost& cost) {
  const auto samples = static_cast<double>(task.scene_samples());
  const double ours_ns = 1e6 * cost.sheets.cpu_ms / samples;
  const Elapsed& frame = cost.frame;
  const double staged = cost.rasterize.cpu_ms + cost.sheets.cpu_ms + cost.resolve.cpu_ms;
  return {{"planes", task.planes()},
          {"pixels_per_voxel", task.scale() * task.scale()},
          {"samples_m", 1e-6 * samples},
          {"fill", task.fill()},
          {"frame_cpu", frame.cpu_ms},
          {"sheets_cpu", cost.sheets.cpu_ms},
          {"resolve_cpu", cost.resolve.cpu_ms},
          {"other_share", std::max(0.0, 1 - staged / frame.cpu_ms)},
          {"ns", ours_ns},
          {"dense_ns", cost.dense_ns},
          {"over_dense", ours_ns / cost.dense_ns},
          {"packed_cpu", cost.packed.cpu_ms},
          {"over_packed", cost.over_packed},
          {"one_wall", cost.one.wall_ms},
          {"two_wall", cost.two.wall_ms},
          {"speedup", cost.two_thread_speedup}};
}

Table limit_table() {
  return {
      "limit",
      "Composited samples against the limit of the machine, parallel projection, normal quality",
      {"ns: CPU time of one thread in sheets, per absorbing voxel, slab and sheet pixel, without early ray "
       "termination",
       "dense_ns: per sample of a plain SIMD loop (bilinear, under, no exponential) over a dense volume of "
       "as many samples, planes and pixels of the sheet",
       "packed_cpu: sheets of the same voxels packed into one array: over_packed - 1 is the cost of "
       "traversal",
       "fill: share of the span blocks of 16 voxels that selected voxels fill",
       "other_share: share of CPU time outside sheets, resolve and rasterising",
       "speedup: one thread over two, wall clock, with early ray termination",
       "times: minimum over repeats of a frame; medians over frames"},
      {}};
}

}  // namespace

Result<Report> run_limit_bench(const BenchOptions& options) {
  Report report;
  SPLATLAS_ASSIGN_OR_RETURN(const std::shared_ptr<const Atlas> atlas, open_colin27(options));
  SPLATLAS_ASSIGN_OR_RETURN(const AtlasContent content, atlas->read_all());
  const Effort effort = options.quick ? Effort{.sizes = {512}, .frames = 3, .thread_repeats = 6} : Effort{};
  Table table = limit_table();
  for (const ErrorScene& scene : error_scenes()) {
    for (const ErrorAppearance& appearance : kAppearances) {
      SPLATLAS_ASSIGN_OR_RETURN(const ErrorModel model, error_model(content, scene, appearance));
      for (const int size : effort.sizes) {
        options.tell(fmt::format("{}, {}, {}x{}", scene.name, appearance.name, size, size));
        LimitTask task(atlas, model, size, effort.frames);
        const ErrorTask error_task{atlas, model, {size, size}, effort.frames, effort.repeats};
        SPLATLAS_ASSIGN_OR_RETURN(LimitCost cost, measure(task, effort));
        SPLATLAS_RETURN_IF_ERROR(measure_threads(error_task, effort.thread_repeats, cost));
        Row row{{"scene", scene.name}, {"transfer", appearance.name}, {"size", size}};
        row.update(row_of(task, cost));
        raise(report.summary, "over_dense", row["over_dense"].get<double>());
        lower(report.summary, "two_thread_speedup", cost.two_thread_speedup);
        raise(report.summary, "traversal_overhead", cost.over_packed - 1);
        raise(report.summary, "other_share_max", row["other_share"].get<double>());
        table.rows.push_back(std::move(row));
      }
    }
  }
  report.tables.push_back(std::move(table));
  return report;
}

}  // namespace splatlas

// Bench `limit`: distance of the renderer from the limit of the machine.
#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include <fmt/format.h>

#include "bench/bench.h"
#include "bench/experiments/dense_kernel.h"
#include "bench/experiments/full_traversal.h"
#include "bench/measure/measure.h"
#include "bench/scenes/atlases.h"
#include "bench/scenes/participants.h"
#include "format/result_macros.h"

namespace splatlas {
namespace {

/// White volumes have one colour to composite, coloured ones three.
constexpr std::array kAppearances{ErrorAppearance{"thin", "profile=thin,opacity=0.01,color=#ffffff"},
                                  ErrorAppearance{"soft", "opacity=0.3,color=#ffffff"},
                                  ErrorAppearance{"thin, coloured", "profile=thin,opacity=0.01"}};

/// CPU time per sample in sheets of one scene, unlit, without early ray termination: an absorbing voxel, slab
/// and sheet pixel. Beside it that of the dense kernel, with as many samples and sheets of equal size.
/// Minimum over repeats of each frame, median over frames.
Result<Row> measure_samples(const ErrorTask& task, const VoxelModel& model) {
  FullTraversal full(task.atlas, model, 1);
  full.select(task.model.selection);
  std::vector<Elapsed> ours, dense;
  DenseVolume volume;
  DenseSheet sheet;
  double samples_m = 0;
  for (int turn = 0; turn < task.turns(); ++turn) {
    SPLATLAS_ASSIGN_OR_RETURN(
        const FullTraversal::Frame frame,
        full.render(task.camera(turn),
                    {.size = task.size, .hybrid_shading = false, .termination_threshold = 0.0f}));
    const SheetWindow& window = frame.window;
    const double pixels = window.scale * window.scale;
    const auto count = static_cast<double>(frame.drawn.voxels_visited) * pixels * window.parts;
    const double per_slice = static_cast<double>(window.columns * window.rows) * pixels;
    const auto slices = static_cast<std::int64_t>(std::ceil(count / per_slice));
    if (volume.columns != window.columns || volume.rows != window.rows || volume.slices != slices)
      volume = DenseVolume::fog(window.columns, window.rows, slices, frame.planes);
    sheet.scale = window.scale;
    Stopwatch watch;
    composite_dense(volume, sheet);
    const double dense_ms = watch.lap().cpu_ms;
    ours.push_back({.wall_ms = 1, .cpu_ms = frame.drawn.sheets.cpu_ms / count});
    dense.push_back({.wall_ms = 1, .cpu_ms = dense_ms / (per_slice * static_cast<double>(slices))});
    samples_m = 1e-6 * count;
  }
  const auto best = best_of_repeats(ours, task.frames), limit = best_of_repeats(dense, task.frames);
  return Row{{"samples_m", samples_m},
             {"ns", 1e6 * median(best).cpu_ms},
             {"dense_ns", 1e6 * median(limit).cpu_ms},
             {"over_dense", median_ratio(best, limit).cpu_ms}};
}

/// Steady frames of the player, lit, by one and two threads. Other load takes a core from the second thread:
/// many repeats.
Result<Row> measure_threads(const ErrorTask& task) {
  std::vector<Participant> participants;
  for (const unsigned threads : {1u, 2u}) {
    SPLATLAS_RETURN_IF_ERROR(
        add_ours(task, Classification::kBefore, threads, participants, std::span(kQualities).subspan(1, 1)));
  }
  std::vector<Contender> contenders;
  for (const Participant& participant : participants) {
    contenders.emplace_back([&](int turn) -> Result<std::vector<Elapsed>> {
      Stopwatch watch;
      SPLATLAS_RETURN_IF_ERROR(participant.draw(task.camera(turn)));
      const Elapsed frame = watch.lap();
      const RenderStats& stats = *participant.stats();
      return std::vector{frame, stats.rasterize + stats.sheets + stats.resolve};
    });
  }
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<StageTimes> times,
                            measure_interleaved(contenders, task.turns()));
  const auto one = best_of_repeats(times[0][0], task.frames), two = best_of_repeats(times[1][0], task.frames);
  const auto drawing = best_of_repeats(times[0][1], task.frames);
  return Row{{"one_wall", median(one).wall_ms},
             {"two_wall", median(two).wall_ms},
             {"speedup", median_ratio(one, two).wall_ms},
             {"traversal_share", 1 - median(drawing).cpu_ms / median(one).cpu_ms}};
}

}  // namespace

Result<Report> run_limit_bench(const BenchOptions& options) {
  Report report;
  SPLATLAS_ASSIGN_OR_RETURN(const std::shared_ptr<const Atlas> atlas, open_colin27(options));
  SPLATLAS_ASSIGN_OR_RETURN(const AtlasContent content, atlas->read_all());
  SPLATLAS_ASSIGN_OR_RETURN(VoxelModel voxels, read_voxel_model(*atlas));
  voxels.surfaces.clear();
  Table table{
      "limit",
      "Composited samples against the limit of the machine, parallel projection, normal quality",
      {"ns: CPU time of one thread in sheets, per absorbing voxel, slab and sheet pixel, without early ray "
       "termination",
       "dense_ns: per sample of a plain SIMD loop over a dense volume",
       "traversal_share: of the CPU time of a steady frame, all but sheets, resolve and rasterising",
       "speedup: one thread over two, wall clock, with early ray termination"}};
  for (const ErrorScene& scene : error_scenes()) {
    for (const ErrorAppearance& appearance : kAppearances) {
      SPLATLAS_ASSIGN_OR_RETURN(const ErrorModel model, error_model(content, scene, appearance));
      for (const int size : {512, 1024}) {
        if (options.quick && size != 512) continue;
        options.tell(fmt::format("{}, {}, {}x{}", scene.name, appearance.name, size, size));
        const int frames = options.quick ? 3 : 7;
        SPLATLAS_ASSIGN_OR_RETURN(const Row samples,
                                  measure_samples({atlas, model, {size, size}, frames, 3}, voxels));
        SPLATLAS_ASSIGN_OR_RETURN(
            const Row threads, measure_threads({atlas, model, {size, size}, frames, options.quick ? 6 : 12}));
        Row& row = table.rows.emplace_back(
            Row{{"scene", scene.name}, {"transfer", appearance.name}, {"size", size}});
        row.update(samples);
        row.update(threads);
        raise(report.summary, "over_dense", row["over_dense"].get<double>());
        lower(report.summary, "two_thread_speedup", row["speedup"].get<double>());
        raise(report.summary, "traversal_overhead", row["traversal_share"].get<double>());
      }
    }
  }
  report.tables.push_back(std::move(table));
  return report;
}

}  // namespace splatlas

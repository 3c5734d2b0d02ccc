// Bench `models`: cost of other models (paper, section 5): run models per level of the tree, and an octree of
// classes.
#include <array>
#include <map>
#include <tuple>

#include <fmt/format.h>

#include "bench/bench.h"
#include "bench/experiments/class_models.h"
#include "bench/experiments/full_traversal.h"
#include "bench/measure/frames.h"
#include "bench/measure/measure.h"
#include "bench/scenes/atlases.h"
#include "format/result_macros.h"
#include "player/renderer.h"

namespace splatlas {
namespace {

constexpr std::array kScenes{
    BenchScene{"head", "Head:volume(color=#ffffff)"},
    BenchScene{"brain", "Brain:volume(color=#ffffff) - \"Rest of brain\""},
    BenchScene{"brain, own colours", "Brain:volume - \"Rest of brain\""},
    BenchScene{"left", "\"Left hemisphere\":volume(color=#ffffff)"},
    BenchScene{"lobe", "\"Frontal lobe\":volume(color=#ffffff)"},
    BenchScene{"scattered", "*_Inf_*:volume(color=#ffffff) + *_Mid_*:volume(color=#ffffff)"},
    BenchScene{"gyrus", "Precentral_L:volume(color=#ffffff)"},
    BenchScene{"one", "Hippocampus_L:volume(color=#ffffff) + Amygdala_L:volume(color=#ffffff)"}};

enum Model : std::size_t { kRuns, kLevels, kOctree };
constexpr std::array kModelNames{"one run model", "run models by level", "octree to bricks of 8"};

/// As draws_by_class(), but classes of equal appearance share their first entry: unlit, they are one.
std::vector<std::uint32_t> shared_draws(const WalkedScene& scene) {
  std::vector<std::uint32_t> draws = draws_by_class(scene.plan, scene.classes.size());
  std::map<std::tuple<std::array<float, 3>, float, const TransferTable*>, std::uint32_t> first;
  for (std::uint32_t& draw : draws) {
    if (draw == kNotDrawn) continue;
    const VolumeAppearance& look = scene.appearances[draw];
    draw = first.try_emplace({look.color, look.extinction_per_mm, look.transfer}, draw).first->second;
  }
  return draws;
}

/// Runs of classes, as in the player.
FullTraversal::FindSpans by_runs(const ClassCache& cache) {
  return [&](const WalkedScene& scene, Axis axis, ThreadPool& pool) {
    const std::vector<std::uint32_t> draws = shared_draws(scene);
    const SelectedRuns selected(scene.plan, scene.classes, cache, axis);
    return walk_spans(scene, axis, pool, [&](std::int64_t slice, const auto& take) {
      if (slice < selected.box().first[2] || slice > selected.box().last[2]) return;
      selected.for_each(slice, [&](const ClassRun& run, std::uint32_t) {
        take(WalkedRun{run.row, run.start, run.length, draws[run.id]});
      });
    });
  };
}

/// Runs that another model collects.
FullTraversal::FindSpans by_collected(const auto& collect) {
  return [collect, runs = RunCollector()](const WalkedScene& scene, Axis axis, ThreadPool& pool) mutable {
    runs.start(scene.grid.size, axis);
    collect(shared_draws(scene), axis, runs);
    return walk_spans(scene, axis, pool,
                      [&](std::int64_t slice, const auto& take) { runs.for_each(slice, take); });
  };
}

/// The first frames of a selection, unlit, as only the lowest level separates boundaries. From the model to
/// spans, and the whole frame. Adds the number of values whose bits differ from the player's.
Contender first_frames(FullTraversal& model, Renderer& player, int frames, std::uint64_t& differ) {
  return [&, frames](int turn) -> Result<std::vector<Elapsed>> {
    const RenderOptions unlit{.hybrid_shading = false};
    const Camera camera = turned(oblique_camera(), turn, frames);
    SPLATLAS_ASSIGN_OR_RETURN(const FullTraversal::Frame frame, model.render(camera, unlit));
    SPLATLAS_ASSIGN_OR_RETURN(const Frame expected, player.render(camera, unlit));
    differ += bits_differ(frame.picture.rgba, expected.picture.rgba);
    return std::vector<Elapsed>{frame.traversal, frame.traversal + frame.drawn.sheets + frame.drawn.resolve};
  };
}

}  // namespace

Result<Report> run_models_bench(const BenchOptions& options) {
  Report report;
  const int frames = options.quick ? 3 : 7, repeats = options.quick ? 1 : 5;
  SPLATLAS_ASSIGN_OR_RETURN(const std::shared_ptr<const Atlas> atlas, open_colin27(options));
  options.tell("building the other models");
  ClassCache cache(atlas);
  ThreadPool pool(1);
  std::vector<ClassId> all;
  for (ClassId c = 1; c < atlas->classes().size(); ++c) all.push_back(c);
  for (const Axis axis : kAxes) SPLATLAS_RETURN_IF_ERROR(cache.require(all, axis, pool));
  SPLATLAS_ASSIGN_OR_RETURN(VoxelModel voxels, read_voxel_model(*atlas));
  voxels.surfaces.clear();
  SPLATLAS_ASSIGN_OR_RETURN(const LevelRuns levels, LevelRuns::build(*atlas));
  const ClassOctree octree(voxels.classes, voxels.grid.size);
  const auto collect_levels = [&](const auto& draws, Axis axis, RunCollector& runs) {
    levels.collect(draws, axis, runs);
  };
  const auto collect_octree = [&](const auto& draws, Axis, RunCollector& runs) {
    octree.collect(draws, runs);
  };
  std::array models{FullTraversal(atlas, voxels, 1, by_runs(cache)),
                    FullTraversal(atlas, voxels, 1, by_collected(collect_levels)),
                    FullTraversal(atlas, voxels, 1, by_collected(collect_octree))};
  Renderer player(atlas, {.threads = 1});
  Table table{"time",
              "The first frame of a selection through each model, 512x512, one thread",
              {"traversal: from the model to spans; frame_ratio: CPU time over that of one run model",
               "pictures are the same, bit for bit"}};
  std::array<std::vector<double>, kModelNames.size()> ratios;
  for (const BenchScene& scene : kScenes) {
    options.tell(scene.name);
    SPLATLAS_ASSIGN_OR_RETURN(const Selection selection, Selection::parse(scene.selection, atlas->graph()));
    SPLATLAS_RETURN_IF_ERROR(player.select(selection));
    std::uint64_t differ = 0;
    std::vector<Contender> contenders;
    for (FullTraversal& model : models) {
      model.select(selection);
      contenders.push_back(first_frames(model, player, frames, differ));
    }
    SPLATLAS_RETURN_IF_ERROR(measure_interleaved(contenders, 1));  // fresh memory
    SPLATLAS_ASSIGN_OR_RETURN(const std::vector<StageTimes> times,
                              measure_interleaved(contenders, frames * repeats));
    for (std::size_t n = 0; n < kModelNames.size(); ++n) {
      ratios[n].push_back(median_ratio(times[n][1], times[kRuns][1], frames).cpu_ms);
      table.rows.push_back({{"scene", scene.name},
                            {"model", kModelNames[n]},
                            {"traversal_cpu", median(times[n][0]).cpu_ms},
                            {"frame_cpu", median(times[n][1]).cpu_ms},
                            {"frame_ratio", ratios[n].back()}});
    }
    if (differ > 0)
      report.failures.push_back(fmt::format("{}: {} numbers of the pictures differ", scene.name, differ));
  }
  report.tables.push_back(std::move(table));
  report.summary["octree_over_runs_time_median"] = median(ratios[kOctree]);
  report.summary["levels_over_runs_time_median"] = median(ratios[kLevels]);
  return report;
}

}  // namespace splatlas

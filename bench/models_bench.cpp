// Bench `models`: cost of other models (paper, section 5): run models per level of the tree, and octrees over
// the classes.
#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "bench/atlases.h"
#include "bench/bench.h"
#include "bench/measure.h"
#include "bench/model_frames.h"
#include "format/codec/chunk_codec.h"
#include "format/codec/run_codec.h"
#include "format/system/result_macros.h"

namespace splatlas {
namespace {

constexpr int kZstdLevel = 12;

struct NamedSelection {
  const char* name;
  const char* selection;
};
constexpr std::array kScenes{
    NamedSelection{"head", "Head:volume(color=#ffffff)"},
    NamedSelection{"brain", "Brain:volume(color=#ffffff) - \"Rest of brain\""},
    NamedSelection{"brain, own colours", "Brain:volume - \"Rest of brain\""},
    NamedSelection{"left", "\"Left hemisphere\":volume(color=#ffffff)"},
    NamedSelection{"lobe", "\"Frontal lobe\":volume(color=#ffffff)"},
    NamedSelection{"scattered", "*_Inf_*:volume(color=#ffffff) + *_Mid_*:volume(color=#ffffff)"},
    NamedSelection{"gyrus", "Precentral_L:volume(color=#ffffff)"},
    NamedSelection{"one", "Hippocampus_L:volume(color=#ffffff) + Amygdala_L:volume(color=#ffffff)"}};

/// Compressed size of a file representation.
std::uint64_t compressed(std::span<const std::byte> bytes) {
  return encode_chunk(bytes, kZstdLevel).bytes.size();
}

Result<Table> memory_table(const Models& models) {
  Table table{
      "memory",
      "Size of the models, all three axes",
      {"bytes: in memory; per_voxel: of the grid; zstd: run lists as an atlas file codes them, an octree",
       "as columns of its arrays, in one chunk each"},
      {}};
  const auto voxels = static_cast<double>(models.atlas->grid().voxels());
  const auto add = [&](Model model, const char* parts, std::uint64_t count, std::uint64_t bytes,
                       std::uint64_t zstd) {
    table.rows.push_back({{"model", name_of(model)},
                          {"parts", parts},
                          {"count", count},
                          {"bytes", bytes},
                          {"per_voxel", static_cast<double>(bytes) / voxels},
                          {"zstd", zstd}});
  };
  std::uint64_t runs = 0, level_runs = 0, zstd = 0, level_zstd = 0;
  for (const Axis axis : kAxes) {
    runs += models.atlas->runs(axis);
    level_runs += models.levels.runs(axis);
    std::vector<std::byte> lists;
    for (ClassId c = 1; c < models.atlas->classes().size(); ++c) {
      SPLATLAS_ASSIGN_OR_RETURN(const ClassRuns of_class, models.atlas->read_runs(c, axis));
      append_run_list(of_class, lists);
    }
    zstd += compressed(lists);
    level_zstd += compressed(models.levels.encoded(axis));
  }
  add(Model::kRuns, "runs", runs, runs * sizeof(ClassRun), zstd);
  add(Model::kLevels, "runs", level_runs, level_runs * sizeof(Run), level_zstd);
  const ClassOctree& fine = models.voxel_octree;
  const ClassOctree& coarse = models.brick_octree;
  add(Model::kVoxelOctree, "nodes", fine.nodes(), fine.bytes(), compressed(fine.encoded()));
  add(Model::kBrickOctree, "nodes", coarse.nodes(), coarse.bytes(), compressed(coarse.encoded()));
  return table;
}

/// Frame times of a scene relative to the run model, per model.
using Ratios = std::array<double, kModels.size()>;

Result<Ratios> measure_scene(ModelFrames& task, const NamedSelection& scene, bool quick, Table& table,
                             Report& report) {
  const int frames = quick ? 3 : 7;
  const int repeats = quick ? 1 : 5;
  SPLATLAS_RETURN_IF_ERROR(task.select(scene.selection));
  std::vector<Contender> contenders;
  for (const Model model : kModels) {
    contenders.emplace_back([&task, model, frames](int turn) { return task.draw(model, turn, frames); });
  }
  SPLATLAS_RETURN_IF_ERROR(measure_interleaved(contenders, 1));  // fresh memory
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<StageTimes> times,
                            measure_interleaved(contenders, frames * repeats));
  Ratios ratios{};
  for (std::size_t n = 0; n < kModels.size(); ++n) {
    const auto ms = [&](std::size_t stage) { return median(times[n][stage]).cpu_ms; };
    ratios[n] = median_ratio(times[n][ModelFrames::kFrame], times[0][ModelFrames::kFrame], frames).cpu_ms;
    table.rows.push_back(
        {{"scene", scene.name},
         {"model", name_of(kModels[n])},
         {"voxels", task.voxels()},
         {"runs", task.runs()},
         {"find_cpu", ms(ModelFrames::kFind)},
         {"spans_cpu", ms(ModelFrames::kSpans)},
         {"draw_cpu", ms(ModelFrames::kDraw)},
         {"frame_cpu", ms(ModelFrames::kFrame)},
         {"frame_wall", median(times[n][ModelFrames::kFrame]).wall_ms},
         {"traversal_ratio",
          median_ratio(times[n][ModelFrames::kTraversal], times[0][ModelFrames::kTraversal], frames).cpu_ms},
         {"frame_ratio", ratios[n]}});
  }
  if (task.bits_differ() > 0) {
    report.failures.push_back(
        fmt::format("{}: {} numbers of the pictures differ", scene.name, task.bits_differ()));
  }
  return ratios;
}

}  // namespace

Result<Report> run_models_bench(const BenchOptions& options) {
  Report report;
  ThreadPool pool(1);
  SPLATLAS_ASSIGN_OR_RETURN(std::shared_ptr<const Atlas> atlas, open_colin27(options));
  options.tell("building the other models");
  SPLATLAS_ASSIGN_OR_RETURN(const Models models, Models::make(std::move(atlas), pool));
  SPLATLAS_ASSIGN_OR_RETURN(Table memory, memory_table(models));
  report.tables.push_back(std::move(memory));

  Table table{
      "time",
      "The first frame of a selection through each model, 512x512, one thread",
      {"find: runs of other models; spans: from runs to spans, retrieval included for the run model; draw:",
       "from spans to the picture; ratios: CPU time over that of one run model; traversal is find and spans",
       "later frames of a selection draw only, and the same spans with every model",
       "pictures are the same, bit for bit"},
      {}};
  std::array<std::vector<double>, kModels.size()> ratios;
  for (const NamedSelection& scene : kScenes) {
    options.tell(scene.name);
    ModelFrames task(models, pool);
    SPLATLAS_ASSIGN_OR_RETURN(const Ratios measured,
                              measure_scene(task, scene, options.quick, table, report));
    for (std::size_t n = 0; n < measured.size(); ++n) ratios[n].push_back(measured[n]);
  }
  report.tables.push_back(std::move(table));
  const auto ratio = [&](Model model) { return median(ratios[static_cast<std::size_t>(model)]); };
  // The better of the two octrees.
  report.summary["octree_over_runs_time_median"] =
      std::min(ratio(Model::kVoxelOctree), ratio(Model::kBrickOctree));
  report.summary["levels_over_runs_time_median"] = ratio(Model::kLevels);
  return report;
}

}  // namespace splatlas

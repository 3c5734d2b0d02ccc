// Bench `scale`: growth of cost with the voxels of an atlas: none for a fixed selection, proportional for one
// that grows; a CT as large as a clinic's.
#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "bench/bench.h"
#include "bench/experiments/changed_content.h"
#include "bench/measure/frames.h"
#include "bench/measure/measure.h"
#include "bench/scenes/atlases.h"
#include "format/atlas_writer.h"
#include "format/result_macros.h"
#include "player/renderer.h"
#include "tests/reference/picture_difference.h"
#include "tests/support/temporary_folder.h"

namespace splatlas {
namespace {

constexpr int kSide = 512;  // pixels
/// Maximum RMS difference between pictures of one selection, 1/255: in a larger grid, slices meet sheets at
/// other subpixel positions.
constexpr double kMaxRms = 1;

/// One size of the atlas.
struct Step {
  int times = 1;  // factor of voxels
  Index3 along;   // factor along each axis, for surrounded atlases
};
constexpr std::array kSteps{Step{1, {1, 1, 1}}, Step{2, {2, 1, 1}}, Step{4, {2, 2, 1}}, Step{8, {2, 2, 2}}};

constexpr std::array kSame{
    BenchScene{"brain",
               "\"Left hemisphere\":volume(color=#ffffff) + \"Right hemisphere\":volume(color=#ffffff)"},
    BenchScene{"left", "\"Left hemisphere\":volume(color=#ffffff)"},
    BenchScene{"one", "Hippocampus_L:volume(color=#ffffff) + Amygdala_L:volume(color=#ffffff)"}};
constexpr const char* kAll = "Head:volume(color=#ffffff)";

struct Effort {
  int frames = 7;
  int repeats = 5;
};

/// A selection in an atlas of one size, with its latest frame.
struct Contestant {
  Step step;
  std::shared_ptr<const Atlas> atlas;
  Renderer renderer;
  RenderOptions options = {};
  Frame frame = {};  // the latest one

  static Result<Contestant> make(const Step& step, const std::filesystem::path& path, const char* selection,
                                 int side) {
    SPLATLAS_ASSIGN_OR_RETURN(const std::shared_ptr<const Atlas> atlas, Atlas::open(path));
    Contestant made{step, atlas, Renderer(atlas, {.threads = 1})};
    made.options = {.size = {side, side}, .hybrid_shading = false};  // the atlas has no normals
    SPLATLAS_ASSIGN_OR_RETURN(const Selection selected, Selection::parse(selection, atlas->graph()));
    SPLATLAS_RETURN_IF_ERROR(made.renderer.select(selected));
    return made;
  }

  Result<void> draw(int turn, int frames) {
    return renderer.render(turned(oblique_camera(), turn, frames), options, frame);
  }
};

/// Times by turn, of every contestant. First turns build spans of another axis: they are drawn once ahead of
/// measurements.
Result<std::vector<std::vector<Elapsed>>> take_times(std::vector<Contestant>& contestants,
                                                     const Effort& effort) {
  std::vector<Contender> contenders;
  for (Contestant& contestant : contestants) {
    contenders.push_back(timed([&](int turn) { return contestant.draw(turn, effort.frames); }));
  }
  SPLATLAS_RETURN_IF_ERROR(measure_interleaved(contenders, effort.frames));
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<StageTimes> stages,
                            measure_interleaved(contenders, effort.frames * effort.repeats));
  std::vector<std::vector<Elapsed>> times;
  for (const StageTimes& contender : stages) times.push_back(contender[0]);
  return times;
}

std::filesystem::path surrounded_path(const std::filesystem::path& folder, const Step& step) {
  return folder / fmt::format("surrounded_{}.atlas", step.times);
}
std::filesystem::path refined_path(const std::filesystem::path& folder, const Step& step) {
  return folder / fmt::format("refined_{}.atlas", step.times);
}

/// Writes the atlas at every size.
Result<void> write_atlases(const std::filesystem::path& folder, const BenchOptions& options) {
  SPLATLAS_ASSIGN_OR_RETURN(const std::shared_ptr<const Atlas> atlas, open_colin27(options));
  SPLATLAS_ASSIGN_OR_RETURN(const AtlasContent content, atlas->read_all());
  for (const Step& step : kSteps) {
    options.tell(fmt::format("building atlases of {} times the voxels", step.times));
    SPLATLAS_ASSIGN_OR_RETURN(const AtlasContent around, surrounded(content, step.along));
    SPLATLAS_RETURN_IF_ERROR(write_atlas(around, surrounded_path(folder, step), {.level = 1}));
    Index3 finer = storage_grid(content).size;
    for (std::int64_t& n : finer) n = std::llround(static_cast<double>(n) * std::cbrt(step.times));
    SPLATLAS_RETURN_IF_ERROR(write_atlas(refined(content, finer), refined_path(folder, step), {.level = 1}));
  }
  return {};
}

Row row_of(const Contestant& contestant, const std::vector<Elapsed>& times) {
  const Elapsed frame = median(times);
  const Atlas& atlas = *contestant.atlas;
  return {{"times", contestant.step.times},
          {"voxels", atlas.grid().voxels()},
          {"wall_ms", frame.wall_ms},
          {"cpu_ms", frame.cpu_ms}};
}

Result<void> add_same(const std::filesystem::path& folder, const Effort& effort, const BenchOptions& options,
                      Report& report) {
  Table table{"same",
              "The same selection, more voxels around it: frames of 512x512, one thread",
              {"growth: CPU time of frames over that in the original atlas",
               "rms: of the last picture, against that of the original atlas, in 1/255"}};
  double largest = 0;
  for (const BenchScene& scene : kSame) {
    options.tell(fmt::format("{}, surrounded", scene.name));
    std::vector<Contestant> contestants;
    for (const Step& step : kSteps) {
      SPLATLAS_ASSIGN_OR_RETURN(
          Contestant made, Contestant::make(step, surrounded_path(folder, step), scene.selection, kSide));
      contestants.push_back(std::move(made));
    }
    SPLATLAS_ASSIGN_OR_RETURN(const auto times, take_times(contestants, effort));
    for (std::size_t n = 0; n < contestants.size(); ++n) {
      const double growth = median_ratio(times[n], times[0], effort.frames).cpu_ms;
      const double rms =
          reference::whole_picture_rms(contestants[n].frame.picture, contestants[0].frame.picture);
      Row& row = table.rows.emplace_back(Row{{"scene", scene.name}});
      row.update(row_of(contestants[n], times[n]));
      row.update({{"growth", growth}, {"rms", rms}});
      const RenderStats &stats = contestants[n].frame.stats, &unit = contestants[0].frame.stats;
      if (stats.runs_visited != unit.runs_visited || stats.voxels_visited != unit.voxels_visited ||
          rms > kMaxRms) {
        report.failures.push_back(fmt::format("{} among {} times the voxels: the picture differs", scene.name,
                                              contestants[n].step.times));
      }
      if (n + 1 == contestants.size()) largest = std::max(largest, growth);
    }
  }
  report.summary["same_selection_growth"] = largest;
  report.tables.push_back(std::move(table));
  return {};
}

Result<void> add_all(const std::filesystem::path& folder, const Effort& effort, const BenchOptions& options,
                     Report& report) {
  Table table{"all",
              "Everything selected, finer grids, as many pixels per voxel: one thread",
              {"growth: CPU time per grid voxel over that of the original atlas"}};
  options.tell("everything");
  std::vector<Contestant> contestants;
  for (const Step& step : kSteps) {
    const int side = static_cast<int>(std::lround(kSide * std::cbrt(step.times)));
    SPLATLAS_ASSIGN_OR_RETURN(Contestant made,
                              Contestant::make(step, refined_path(folder, step), kAll, side));
    contestants.push_back(std::move(made));
  }
  SPLATLAS_ASSIGN_OR_RETURN(const auto times, take_times(contestants, effort));
  const auto voxels = [&](std::size_t n) {
    return static_cast<double>(contestants[n].atlas->grid().voxels());
  };
  for (std::size_t n = 0; n < contestants.size(); ++n) {
    const double growth = median_ratio(times[n], times[0], effort.frames).cpu_ms * voxels(0) / voxels(n);
    table.rows.push_back(row_of(contestants[n], times[n]));
    table.rows.back()["growth"] = growth;
    report.summary["all_growth_per_voxel"] = growth;  // the last one stays
  }
  report.tables.push_back(std::move(table));
  return {};
}

}  // namespace

Result<Report> run_scale_bench(const BenchOptions& options) {
  const Effort effort = options.quick ? Effort{3, 1} : Effort{};
  Report report;
  const TemporaryFolder folder;
  SPLATLAS_RETURN_IF_ERROR(write_atlases(folder.path(), options));
  SPLATLAS_RETURN_IF_ERROR(add_same(folder.path(), effort, options, report));
  SPLATLAS_RETURN_IF_ERROR(add_all(folder.path(), effort, options, report));
  SPLATLAS_RETURN_IF_ERROR(add_clinic(options, report));
  return report;
}

}  // namespace splatlas

// Bench `build`: time of preprocessing by stage, run encoding, memory.
#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "bench/bench.h"
#include "bench/measure/measure.h"
#include "bench/scenes/atlases.h"
#include "format/content/run_model.h"
#include "format/result_macros.h"
#include "tests/support/temporary_folder.h"

namespace splatlas {
namespace {

/// CPU time of cutting the class volume into runs along all three axes, minimum over repeats, in ns per
/// voxel.
double runs_ns_per_voxel(const AtlasContent& content, int repeats) {
  double sum_ms = 0;
  for (const Axis axis : kAxes) {
    std::vector<double> ms;
    for (int repeat = 0; repeat < repeats; ++repeat) {
      Stopwatch watch;
      const auto model =
          encode_runs(content.class_volume, storage_grid(content).size, axis, content.classes.size());
      ms.push_back(watch.lap().cpu_ms);
    }
    sum_ms += *std::ranges::min_element(ms);
  }
  return sum_ms * 1e6 / static_cast<double>(content.class_volume.size());
}

}  // namespace

Result<Report> run_build_bench(const BenchOptions& options) {
  Report report;
  SPLATLAS_ASSIGN_OR_RETURN(const SourceFiles sources, colin27_sources());
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "build.atlas";
  std::map<std::string, std::vector<double>> seconds;  // by stage
  std::uint64_t peak_bytes = 0;
  // The first turn does not count: it reads from disk, and takes new memory, which later ones reuse
  for (int turn = 0; turn <= (options.quick ? 1 : 5); ++turn) {
    options.tell(fmt::format("build {}", turn));
    SPLATLAS_ASSIGN_OR_RETURN(const PeakMemory memory, PeakMemory::start());
    Stopwatch watch;
    SPLATLAS_ASSIGN_OR_RETURN(const BuildReport built, build_file(sources, file));
    const Elapsed building = watch.lap();
    SPLATLAS_ASSIGN_OR_RETURN(const std::uint64_t grown, memory.grown_bytes());
    if (turn == 0) peak_bytes = grown;
    watch.lap();
    Notes notes;
    SPLATLAS_RETURN_IF_ERROR(import_sources(sources, notes));
    const Elapsed loading = watch.lap();
    if (turn == 0) continue;
    seconds["all"].push_back(building.wall_ms / 1000);
    seconds["loading alone"].push_back(loading.wall_ms / 1000);
    for (const auto& stage : built.stages) seconds[stage.name].push_back(stage.seconds);
  }
  Table table{"stages", "Building Colin 27's atlas, all threads, wall clock, seconds (medians)"};
  for (const auto& [stage, times] : seconds)
    table.rows.push_back({{"stage", stage}, {"seconds", median(times)}});
  report.tables.push_back(std::move(table));
  SPLATLAS_ASSIGN_OR_RETURN(const auto atlas, Atlas::open(file));
  SPLATLAS_ASSIGN_OR_RETURN(const AtlasContent content, atlas->read_all());
  report.summary["build_seconds"] = median(seconds["all"]);
  report.summary["build_over_load"] = median(seconds["all"]) / median(seconds["loading alone"]);
  report.summary["runs_ns_per_voxel"] = runs_ns_per_voxel(content, options.quick ? 2 : 9);
  report.summary["peak_bytes_per_voxel"] =
      static_cast<double>(peak_bytes) / static_cast<double>(atlas->grid().voxels());
  return report;
}

}  // namespace splatlas

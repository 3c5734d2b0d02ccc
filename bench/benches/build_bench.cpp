// Bench `build`: time of preprocessing by stage, run encoding, memory.
#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "bench/bench.h"
#include "bench/measure/measure.h"
#include "bench/measure/peak_memory.h"
#include "bench/peers/itk_vtk_build.h"
#include "bench/scenes/atlases.h"
#include "format/content/run_model.h"
#include "format/result_macros.h"
#include "preprocess/build/build_atlas.h"
#include "tests/support/temporary_folder.h"

namespace splatlas {
namespace {

/// Alternates builds, plain loading and the peer. The first turn does not count: it reads from disk and takes
/// new memory.
struct Builds {
  std::vector<BuildReport> reports;
  std::vector<double> build_seconds, build_cpu_seconds, load_seconds, peer_seconds, peer_cpu_seconds;
  std::uint64_t peak_bytes = 0;
};

constexpr int kAalLabels = 116;
constexpr double kHeadThreshold = 28;  // as in colin27_sources()

ItkVtkSources peer_sources(const SourceFiles& sources) {
  return {sources.volume, sources.labels, templates_folder() / "ch2bet.nii.gz"};
}

Result<Builds> build_in_turns(const SourceFiles& sources, const std::filesystem::path& output, int turns,
                              const BenchOptions& options) {
  Builds builds;
  for (int turn = 0; turn <= turns; ++turn) {
    options.tell(fmt::format("build {} of {}", turn, turns));
    BuildOptions build;
    build.sources = sources;
    build.tool = "splatlas-bench";
    build.output = output;
    SPLATLAS_ASSIGN_OR_RETURN(const PeakMemory memory, PeakMemory::start());
    Stopwatch watch;
    SPLATLAS_ASSIGN_OR_RETURN(BuildReport report, build_atlas(build));
    const auto built = watch.lap();
    SPLATLAS_ASSIGN_OR_RETURN(const std::uint64_t peak, memory.grown_bytes());
    watch.lap();
    Notes notes;
    SPLATLAS_RETURN_IF_ERROR(import_sources(sources, notes));
    const auto loaded = watch.lap();
    SPLATLAS_RETURN_IF_ERROR(load_and_march(peer_sources(sources), kAalLabels, kHeadThreshold));
    const auto marched = watch.lap();
    if (turn == 0) {
      builds.peak_bytes = peak;  // from fresh memory, which later builds reuse
      continue;
    }
    builds.build_seconds.push_back(built.wall_ms / 1000);
    builds.build_cpu_seconds.push_back(built.cpu_ms / 1000);
    builds.load_seconds.push_back(loaded.wall_ms / 1000);
    builds.peer_seconds.push_back(marched.wall_ms / 1000);
    builds.peer_cpu_seconds.push_back(marched.cpu_ms / 1000);
    builds.reports.push_back(std::move(report));
  }
  return builds;
}

Table stage_table(const Builds& builds) {
  Table table{"stages", "Building Colin 27's atlas, stage by stage, seconds (medians)"};
  for (std::size_t stage = 0; stage < builds.reports[0].stages.size(); ++stage) {
    std::vector<double> seconds;
    for (const BuildReport& report : builds.reports) seconds.push_back(report.stages[stage].seconds);
    table.rows.push_back({{"stage", builds.reports[0].stages[stage].name}, {"seconds", median(seconds)}});
  }
  return table;
}

/// The minimum over repeats, in ns per voxel.
Table measure_runs(const AtlasContent& content, int repeats, nlohmann::ordered_json& summary) {
  Table table{"runs",
              "Run encoding of the class volume, one thread",
              {"ns_per_voxel: CPU time, minimum over repeats"}};
  const Index3 size = storage_grid(content).size;
  double sum = 0;
  for (const Axis axis : kAxes) {
    double min_ms = 0;
    std::uint64_t runs = 0;
    for (int repeat = 0; repeat < repeats; ++repeat) {
      Stopwatch watch;
      runs = encode_runs(content.class_volume, size, axis, content.classes.size()).runs();
      const double ms = watch.lap().cpu_ms;
      min_ms = repeat == 0 ? ms : std::min(min_ms, ms);
    }
    const double ns = min_ms * 1e6 / static_cast<double>(content.class_volume.size());
    table.rows.push_back({{"axis", std::string(1, static_cast<char>('x' + static_cast<int>(axis)))},
                          {"runs", runs},
                          {"ns_per_voxel", ns}});
    sum += ns;
  }
  summary["runs_ns_per_voxel"] = sum;
  return table;
}

}  // namespace

Result<Report> run_build_bench(const BenchOptions& options) {
  Report report;
  SPLATLAS_ASSIGN_OR_RETURN(const SourceFiles sources, colin27_sources());
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "build.atlas";
  SPLATLAS_ASSIGN_OR_RETURN(const Builds builds,
                            build_in_turns(sources, file, options.quick ? 1 : 5, options));
  report.tables.push_back(stage_table(builds));
  SPLATLAS_ASSIGN_OR_RETURN(const auto atlas, Atlas::open(file));
  const double build = median(builds.build_seconds), load = median(builds.load_seconds);
  const double peer = median(builds.peer_seconds);
  report.tables.push_back({"build",
                           "Building Colin 27's atlas beside loading its files, all threads, wall clock",
                           {"load: reading and unpacking volume, labels and masks; peer: loading by ITK and "
                            "marching cubes by VTK, one "
                            "thread, nothing stored; peak: memory of the first build"},
                           {{{"build_seconds", build},
                             {"build_cpu_seconds", median(builds.build_cpu_seconds)},
                             {"load_seconds", load},
                             {"peer_seconds", peer},
                             {"peer_cpu_seconds", median(builds.peer_cpu_seconds)},
                             {"peak_bytes", builds.peak_bytes},
                             {"file_bytes", builds.reports[0].bytes}}}});
  report.summary["build_seconds"] = build;
  report.summary["build_over_load"] = build / load;
  report.summary["build_over_itk_vtk"] = build / peer;
  SPLATLAS_ASSIGN_OR_RETURN(const AtlasContent content, atlas->read_all());
  report.tables.push_back(measure_runs(content, options.quick ? 2 : 9, report.summary));
  report.summary["peak_bytes_per_voxel"] =
      static_cast<double>(builds.peak_bytes) / static_cast<double>(atlas->grid().voxels());
  return report;
}

}  // namespace splatlas

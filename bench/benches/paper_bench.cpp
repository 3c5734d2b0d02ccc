// Benches `phantom` and `head`: tables 1 to 4 of the paper, on its phantom and on the Colin 27 head.
#include <array>
#include <fstream>
#include <sstream>
#include <utility>

#include <fmt/format.h>

#include "bench/bench.h"
#include "bench/experiments/full_traversal.h"
#include "bench/measure/frames.h"
#include "bench/measure/measure.h"
#include "bench/scenes/atlases.h"
#include "bench/scenes/paper_tables.h"
#include "format/result_macros.h"
#include "player/renderer.h"
#include "player/web/page_json.h"

namespace splatlas {
namespace {

/// A figure of the gallery, scripts/gallery.tsv.
struct Figure {
  std::string name;  ///< number in the paper: "5a"
  Camera camera;
  std::string selection;
};

/// Camera options such as "--azimuth 30 --elevation 20 --zoom 2".
Camera parse_camera(const std::string& text) {
  Camera camera;
  std::istringstream words(text);
  for (std::string option; words >> option;) {
    if (option == "--azimuth") words >> camera.azimuth_deg;
    if (option == "--elevation") words >> camera.elevation_deg;
    if (option == "--zoom") words >> camera.zoom;
  }
  return camera;
}

/// Lines of the gallery have name, atlas, view and selection, separated by tabs.
Result<Figure> read_figure(const std::string& name) {
  const std::string path = std::string(SPLATLAS_SOURCE_DIR) + "/scripts/gallery.tsv";
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    std::istringstream columns(line);
    std::array<std::string, 4> cells;
    for (std::string& cell : cells) std::getline(columns, cell, '\t');
    if (cells[0] == name) return Figure{name, parse_camera(cells[2]), cells[3]};
  }
  return fail(ErrorCode::kFailed, fmt::format("{}: has no figure {}", path, name));
}

/// Tables 1 and 3: interior voxels, boundary voxels and triangles of every region.
Result<Table> region_table(const Atlas& atlas, std::span<const paper::Region> regions, Table table) {
  const std::vector<SubtreeCounts> counts_of_all = counts_of(atlas);
  for (const paper::Region& region : regions) {
    SPLATLAS_ASSIGN_OR_RETURN(const std::vector<StructureIndex> found, atlas.graph().find(region.structure));
    const SubtreeCounts& counts = counts_of_all[found.front()];
    table.rows.push_back({{"structure", region.structure},
                          {"interior", counts.interior},
                          {"boundary", counts.boundary},
                          {"triangles", counts.triangles},
                          {"paper_region", region.name},
                          {"paper_interior", region.interior},
                          {"paper_boundary", region.boundary},
                          {"paper_triangles", region.triangles}});
  }
  return table;
}

struct Effort {
  int frames = 7;   ///< 15 degrees apart
  int repeats = 3;  ///< per frame; each turned by a further degree, so that no view repeats
};

Elapsed frame_time(const Elapsed& traversal, const RenderStats& stages) {
  return traversal + stages.rasterize + stages.sheets + stages.resolve;
}

/// One figure in one quality by full traversal and by the turning player, one thread: a row, and its keys in
/// the summary.
Result<Row> measure_figure(const std::shared_ptr<const Atlas>& atlas, FullTraversal& full,
                           const Figure& figure, const NamedQuality& quality, const Effort& effort,
                           Report& report) {
  // Full traversal knows no light of voxels
  const RenderOptions unlit{.quality = quality.quality, .hybrid_shading = false};
  SPLATLAS_ASSIGN_OR_RETURN(const Selection selection, Selection::parse(figure.selection, atlas->graph()));
  full.select(selection);
  Renderer turning(atlas, {.threads = 1});
  SPLATLAS_RETURN_IF_ERROR(turning.select(selection));
  const int turns = effort.frames * effort.repeats;
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<Camera> cameras,
                            cameras_by_axis(figure.camera, turns, effort.frames, *atlas));
  Frame ours;
  for (const Camera& camera : cameras) SPLATLAS_RETURN_IF_ERROR(turning.render(camera, unlit, ours));
  std::vector<Elapsed> full_times, times;
  std::uint64_t differ = 0;
  for (int turn = 0; turn < turns; ++turn) {
    const Camera camera = turned(figure.camera, turn, effort.frames);
    SPLATLAS_ASSIGN_OR_RETURN(const FullTraversal::Frame frame, full.render(camera, unlit));
    SPLATLAS_RETURN_IF_ERROR(turning.render(camera, unlit, ours));
    full_times.push_back(frame_time(frame.traversal, frame.drawn));
    times.push_back(frame_time(ours.stats.traversal, ours.stats));
    differ += bits_differ(ours.picture.rgba, frame.picture.rgba);
  }
  const Elapsed ratio = median_ratio(times, full_times, effort.frames);
  const char* const prefix = quality.quality == Quality::kDraft ? "cost_ratio_draft_" : "cost_ratio_";
  report.summary[prefix + figure.name] = ratio.cpu_ms;
  report.summary["occupancy_" + figure.name] = ours.stats.occupancy;
  if (differ > 0) {
    report.failures.push_back(fmt::format("figure {}, {}: {} numbers differ from full traversal's",
                                          figure.name, quality.name, differ));
  }
  return Row{{"figure", figure.name},
             {"quality", quality.name},
             {"k_vol", ours.stats.volume_voxels},
             {"k_sur", ours.stats.surface_voxels},
             {"k_hyb", ours.stats.hybrid_voxels},
             {"occupancy", ours.stats.occupancy},
             {"full_cpu", median(full_times).cpu_ms},
             {"turning_cpu", median(times).cpu_ms},
             {"cost_ratio", ratio.cpu_ms},
             {"wall_ratio", ratio.wall_ms},
             {"bits_differ", differ}};
}

/// Tables 2 and 4, with `qualities`.
Result<void> add_traversal_table(const std::shared_ptr<const Atlas>& atlas,
                                 std::span<const paper::Traversal> figures, std::uint64_t paper_voxels,
                                 std::span<const NamedQuality> qualities, const BenchOptions& options,
                                 Table table, Report& report) {
  const Effort effort = options.quick ? Effort{.frames = 2, .repeats = 1} : Effort{};
  SPLATLAS_ASSIGN_OR_RETURN(const VoxelModel model, read_voxel_model(*atlas));
  FullTraversal full(atlas, model, 1);
  for (const paper::Traversal& papers : figures) {
    SPLATLAS_ASSIGN_OR_RETURN(const Figure figure, read_figure(papers.figure));
    options.tell(fmt::format("figure {}", figure.name));
    for (const NamedQuality& quality : qualities) {
      SPLATLAS_ASSIGN_OR_RETURN(table.rows.emplace_back(),
                                measure_figure(atlas, full, figure, quality, effort, report));
      table.rows.back().update({{"paper_occupancy", paper::occupancy(papers, paper_voxels)},
                                {"paper_cost_ratio", papers.cost_ratio}});
    }
    table.notes.push_back(fmt::format("{}  {}", figure.name, figure.selection));
  }
  table.notes.emplace_back(
      "cost_ratio: CPU time of a frame of the turning model, one thread, against full traversal");
  report.tables.push_back(std::move(table));
  return {};
}

/// The phantom is exact: any other number than that of the paper is a failure.
void expect(const std::string& what, std::uint64_t ours, std::uint64_t papers, Report& report) {
  if (ours != papers) report.failures.push_back(fmt::format("{}: {}, must be {}", what, ours, papers));
}

}  // namespace

Result<Report> run_phantom_bench(const BenchOptions& options) {
  Report report;
  SPLATLAS_ASSIGN_OR_RETURN(const std::shared_ptr<const Atlas> atlas, open_phantom(options));
  SPLATLAS_ASSIGN_OR_RETURN(Table table_1,
                            region_table(*atlas, paper::kTable1, {"1", "Table 1: the phantom"}));
  for (std::size_t n = 0; n < table_1.rows.size(); ++n) {
    for (const char* what : {"interior", "boundary", "triangles"}) {
      const std::string key = fmt::format("{}_{}", what, n + 1);
      report.summary[key] = table_1.rows[n][what];
      expect(key, table_1.rows[n][what], table_1.rows[n][fmt::format("paper_{}", what)], report);
    }
  }
  report.tables.push_back(std::move(table_1));
  report.summary["empty"] = atlas->classes().voxels(kEmptyClass);
  expect("empty", report.summary["empty"], paper::kPhantomEmpty, report);
  SPLATLAS_RETURN_IF_ERROR(add_traversal_table(atlas, paper::kTable2, paper::kPhantomVoxels,
                                               std::span(kQualities).subspan(1, 1), options,
                                               {"2", "Table 2: traversals of the phantom, 512x512"}, report));
  for (std::size_t n = 0; n < paper::kTable2.size(); ++n) {
    const paper::Traversal& papers = paper::kTable2[n];
    const Row& row = report.tables[1].rows[n];
    expect(fmt::format("figure {}: k_vol", papers.figure), row["k_vol"], papers.volume, report);
    expect(fmt::format("figure {}: k_sur", papers.figure), row["k_sur"], papers.surface, report);
    expect(fmt::format("figure {}: k_hyb", papers.figure), row["k_hyb"], papers.hybrid, report);
  }
  return report;
}

Result<Report> run_head_bench(const BenchOptions& options) {
  Report report;
  SPLATLAS_ASSIGN_OR_RETURN(const std::shared_ptr<const Atlas> atlas, open_colin27(options));
  SPLATLAS_ASSIGN_OR_RETURN(
      report.tables.emplace_back(),
      region_table(*atlas, paper::kTable3,
                   {"3",
                    "Table 3: the head",
                    {"ours has 181x217x181 voxels, the paper's 190x220x178; AAL divides a cerebrum into "
                     "gyri, each with a surface of its own"}}));
  SPLATLAS_RETURN_IF_ERROR(add_traversal_table(atlas, paper::kTable4, paper::kHeadVoxels,
                                               std::span(kQualities).first(2), options,
                                               {"4", "Table 4: traversals of the head, 512x512"}, report));
  return report;
}

}  // namespace splatlas

#include "bench/paper_rows.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "format/system/result_macros.h"

namespace splatlas {
namespace {

Result<StructureIndex> structure_named(const Atlas& atlas, const char* name) {
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<StructureIndex> found, find_structures(atlas.graph(), name));
  return found.front();
}

std::uint64_t triangles_below(const Atlas& atlas, StructureIndex s) {
  std::uint64_t triangles = 0;
  for (const StructureIndex d : atlas.graph().descendants(s)) triangles += atlas.triangles(d);
  return triangles;
}

Result<Figure> figure_named(std::span<const Figure> figures, const char* name) {
  const auto found =
      std::find_if(figures.begin(), figures.end(), [&](const Figure& f) { return f.name == name; });
  if (found == figures.end())
    return fail(ErrorCode::kFailed, fmt::format("the gallery has no figure {}", name));
  return *found;
}

Row traversal_row(const paper::Traversal& paper_row, std::uint64_t paper_voxels, const TraversalCost& one,
                  const TraversalCost& two) {
  return {{"figure", paper_row.figure},
          {"k_vol", one.stats.volume_voxels},
          {"k_sur", one.stats.surface_voxels},
          {"k_hyb", one.stats.hybrid_voxels},
          {"occupancy", one.stats.occupancy},
          {"paper_occupancy", paper::occupancy(paper_row, paper_voxels)},
          {"cost_ratio", one.ratio(Method::kTurning).cpu_ms},
          {"paper_cost_ratio", paper_row.cost_ratio},
          {"wall_ratio", one.ratio(Method::kTurning).wall_ms},
          {"wall_ratio_2t", two.ratio(Method::kTurning).wall_ms},
          {"first_ratio", one.ratio(Method::kNewSelection).cpu_ms},
          {"bits_differ", one.bits_differ + two.bits_differ}};
}

}  // namespace

Result<Table> region_table(const Atlas& atlas, std::span<const paper::Region> regions,
                           const std::string& name, const std::string& title) {
  Table table{name, title, {}, {}};
  for (const paper::Region& region : regions) {
    SPLATLAS_ASSIGN_OR_RETURN(const StructureIndex s, structure_named(atlas, region.structure));
    const DecisionTree::VoxelCounts counts = atlas.tree().voxel_counts(s);
    table.rows.push_back({{"structure", region.structure},
                          {"interior", counts.interior},
                          {"boundary", counts.boundary},
                          {"triangles", triangles_below(atlas, s)},
                          {"paper_region", region.name},
                          {"paper_interior", region.interior},
                          {"paper_boundary", region.boundary},
                          {"paper_triangles", region.triangles}});
  }
  return table;
}

Result<void> add_traversal_tables(const std::shared_ptr<const Atlas>& atlas, const TraversalTable& table,
                                  const BenchOptions& options, Report& report) {
  TraversalEffort effort_one, effort_two{.repeats = 1};
  if (options.quick) effort_one = effort_two = {.frames = 2, .repeats = 1};
  SPLATLAS_ASSIGN_OR_RETURN(const VoxelModel model, read_voxel_model(*atlas));
  Table costs{table.name, table.title, {}, {}};
  Table stages{table.name + " stages",
               "Stages of a frame, medians in milliseconds by the wall clock and of CPU time",
               {},
               {}};
  for (const paper::Traversal& row : table.rows) {
    SPLATLAS_ASSIGN_OR_RETURN(const Figure figure, figure_named(table.figures, row.figure));
    options.tell(fmt::format("figure {}", figure.name));
    SPLATLAS_ASSIGN_OR_RETURN(const TraversalCost one,
                              measure_traversal(atlas, model, figure, 1, effort_one));
    SPLATLAS_ASSIGN_OR_RETURN(const TraversalCost two,
                              measure_traversal(atlas, model, figure, 2, effort_two));
    costs.rows.push_back(traversal_row(row, table.paper_voxels, one, two));
    costs.notes.push_back(fmt::format("{}  {}", figure.name, figure.selection));
    append_stage_rows(figure.name, 1, one, stages);
    append_stage_rows(figure.name, 2, two, stages);
    report.summary["cost_ratio_" + figure.name] = one.ratio(Method::kTurning).cpu_ms;
    report.summary["occupancy_" + figure.name] = one.stats.occupancy;
    if (const std::uint64_t differ = one.bits_differ + two.bits_differ; differ > 0) {
      report.failures.push_back(fmt::format(
          "figure {}: {} numbers of the pictures differ from full traversal's", figure.name, differ));
    }
  }
  costs.notes.emplace_back(
      "cost_ratio: CPU time of a frame of the turning model, one thread, against full traversal");
  costs.notes.emplace_back("first_ratio: the same of the first frame, tree walk and run merging included");
  report.tables.push_back(std::move(costs));
  report.tables.push_back(std::move(stages));
  return {};
}

}  // namespace splatlas

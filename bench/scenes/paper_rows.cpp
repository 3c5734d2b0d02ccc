#include "bench/scenes/paper_rows.h"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>

#include "bench/experiments/full_traversal.h"
#include "bench/measure/frames.h"
#include "bench/measure/measure.h"
#include "format/result_macros.h"
#include "player/renderer.h"

namespace splatlas {
namespace {

Result<StructureIndex> structure_named(const Atlas& atlas, const char* name) {
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<StructureIndex> found, atlas.graph().find(name));
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

/// Methods to draw a frame.
enum Method : std::size_t {
  kFullTraversal,  ///< all voxels and triangles in every frame
  kNewSelection,   ///< first frame of a selection in the player: merges runs, builds spans
  kTurning,        ///< its later frames
};
constexpr std::array kMethods{"full traversal", "new selection", "turning"};

/// Stages of a frame; the last one is the sum of the others.
constexpr std::array kStages{"traversal", "raster", "sheets", "resolve", "frame"};

/// One selection with one number of threads.
struct TraversalCost {
  StageTimes medians;  ///< [method][stage], over frames and repeats
  /// Cost of a method relative to full traversal: median over frames of the ratio of medians over repeats.
  std::array<Elapsed, kMethods.size()> ratios;
  RenderStats stats;              ///< counts of the last frame
  std::uint64_t bits_differ = 0;  ///< differing values of all pictures, player against full traversal
};

struct Effort {
  int frames = 7;   ///< 15 degrees apart
  int repeats = 3;  ///< per frame; each turned by a further degree, so that no view repeats

  [[nodiscard]] int turns() const { return frames * repeats; }
};

std::vector<Elapsed> stages_of(const Elapsed& traversal, const auto& stages) {
  return {traversal, stages.rasterize, stages.sheets, stages.resolve,
          traversal + stages.rasterize + stages.sheets + stages.resolve};
}

/// The three methods to draw the frames of one figure.
class MethodRunner {
 public:
  MethodRunner(const std::shared_ptr<const Atlas>& atlas, const VoxelModel& model, const Figure& figure,
               const Effort& effort, unsigned threads)
      : figure_(figure),
        effort_(effort),
        full_(atlas, model, threads),
        fresh_(atlas, {.threads = threads}),
        turning_(atlas, {.threads = threads}) {}

  /// Selects, and draws one frame per principal axis with both renderers, so that everything is decoded.
  Result<void> prepare() {
    SPLATLAS_ASSIGN_OR_RETURN(selection_, Selection::parse(figure_.selection, turning_.atlas().graph()));
    full_.select(selection_);
    SPLATLAS_RETURN_IF_ERROR(fresh_.select(selection_));
    SPLATLAS_RETURN_IF_ERROR(turning_.select(selection_));
    SPLATLAS_ASSIGN_OR_RETURN(
        const std::vector<Camera> cameras,
        cameras_by_axis(figure_.camera, effort_.turns(), effort_.frames, turning_.atlas()));
    for (const Camera& camera : cameras) {
      SPLATLAS_RETURN_IF_ERROR(fresh_.render(camera, kUnlit));
      SPLATLAS_RETURN_IF_ERROR(turning_.render(camera, kUnlit));
    }
    return {};
  }

  Result<std::vector<Elapsed>> draw(Method method, int turn) {
    const Camera camera = turned(figure_.camera, turn, effort_.frames);
    SPLATLAS_ASSIGN_OR_RETURN(const std::vector<Elapsed> stages,
                              method == kFullTraversal ? draw_full(camera) : draw_player(method, camera));
    if (++drawn_ % kMethods.size() == 0) {
      for (const Method ours : {kNewSelection, kTurning})
        bits_differ_ += splatlas::bits_differ(pictures_[ours], pictures_[kFullTraversal]);
    }
    return stages;
  }

  /// Number of values whose bits differ from those of full traversal.
  [[nodiscard]] std::uint64_t bits_differ() const { return bits_differ_; }
  [[nodiscard]] const RenderStats& stats() const { return stats_; }

 private:
  /// Full traversal knows no light of voxels.
  static constexpr RenderOptions kUnlit{.hybrid_shading = false};

  Result<std::vector<Elapsed>> draw_full(const Camera& camera) {
    SPLATLAS_ASSIGN_OR_RETURN(FullTraversal::Frame frame, full_.render(camera, kUnlit));
    pictures_[kFullTraversal] = std::move(frame.picture.rgba);
    return stages_of(frame.traversal, frame.drawn);
  }

  Result<std::vector<Elapsed>> draw_player(Method method, const Camera& camera) {
    Renderer& renderer = method == kTurning ? turning_ : fresh_;
    Elapsed selecting;
    if (method == kNewSelection) {
      Stopwatch watch;
      SPLATLAS_RETURN_IF_ERROR(renderer.select(selection_));
      selecting = watch.lap();
    }
    SPLATLAS_ASSIGN_OR_RETURN(Frame frame, renderer.render(camera, kUnlit));
    pictures_[method] = std::move(frame.picture.rgba);
    if (method == kTurning) stats_ = frame.stats;
    return stages_of(selecting + frame.stats.traversal, frame.stats);
  }

  const Figure& figure_;
  const Effort& effort_;
  FullTraversal full_;
  Renderer fresh_, turning_;
  Selection selection_;
  RenderStats stats_;                                         // of the latest frame of turning_
  std::array<std::vector<float>, kMethods.size()> pictures_;  // of one turn, by method
  std::size_t drawn_ = 0;
  std::uint64_t bits_differ_ = 0;
};

/// Measures a figure with the three methods interleaved, and compares their pictures.
Result<TraversalCost> measure_traversal(const std::shared_ptr<const Atlas>& atlas, const VoxelModel& model,
                                        const Figure& figure, unsigned threads, const Effort& effort) {
  MethodRunner methods(atlas, model, figure, effort, threads);
  SPLATLAS_RETURN_IF_ERROR(methods.prepare());
  std::vector<Contender> contenders;
  for (const Method method : {kFullTraversal, kNewSelection, kTurning}) {
    contenders.emplace_back([&methods, method](int turn) { return methods.draw(method, turn); });
  }
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<StageTimes> times,
                            measure_interleaved(contenders, effort.turns()));
  TraversalCost cost;
  cost.stats = methods.stats();
  cost.bits_differ = methods.bits_differ();
  for (std::size_t method = 0; method < kMethods.size(); ++method) {
    std::vector<Elapsed>& medians = cost.medians.emplace_back();
    for (const std::vector<Elapsed>& turns : times[method]) medians.push_back(median(turns));
    cost.ratios[method] = median_ratio(times[method].back(), times[0].back(), effort.frames);
  }
  return cost;
}

/// One row per method: wall and CPU milliseconds of every stage.
void append_stage_rows(const std::string& figure, unsigned threads, const TraversalCost& cost, Table& table) {
  for (std::size_t method = 0; method < kMethods.size(); ++method) {
    Row& row =
        table.rows.emplace_back(Row{{"figure", figure}, {"threads", threads}, {"method", kMethods[method]}});
    for (std::size_t stage = 0; stage < kStages.size(); ++stage) {
      row[fmt::format("{}_ms", kStages[stage])] = cost.medians[method][stage].wall_ms;
      row[fmt::format("{}_cpu", kStages[stage])] = cost.medians[method][stage].cpu_ms;
    }
  }
}

Row traversal_row(const paper::Traversal& paper_row, std::uint64_t paper_voxels, const TraversalCost& one,
                  const TraversalCost& two) {
  return {{"figure", paper_row.figure},
          {"k_vol", one.stats.volume_voxels},
          {"k_sur", one.stats.surface_voxels},
          {"k_hyb", one.stats.hybrid_voxels},
          {"occupancy", one.stats.occupancy},
          {"paper_occupancy", paper::occupancy(paper_row, paper_voxels)},
          {"cost_ratio", one.ratios[kTurning].cpu_ms},
          {"paper_cost_ratio", paper_row.cost_ratio},
          {"wall_ratio", one.ratios[kTurning].wall_ms},
          {"wall_ratio_2t", two.ratios[kTurning].wall_ms},
          {"first_ratio", one.ratios[kNewSelection].cpu_ms},
          {"bits_differ", one.bits_differ + two.bits_differ}};
}

}  // namespace

Result<Table> region_table(const Atlas& atlas, std::span<const paper::Region> regions,
                           const std::string& name, const std::string& title) {
  Table table{name, title};
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
  Effort effort_one, effort_two{.repeats = 1};
  if (options.quick) effort_one = effort_two = {.frames = 2, .repeats = 1};
  SPLATLAS_ASSIGN_OR_RETURN(const VoxelModel model, read_voxel_model(*atlas));
  Table costs{table.name, table.title};
  Table stages{table.name + " stages",
               "Stages of a frame, medians in milliseconds by the wall clock and of CPU time"};
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
    report.summary["cost_ratio_" + figure.name] = one.ratios[kTurning].cpu_ms;
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

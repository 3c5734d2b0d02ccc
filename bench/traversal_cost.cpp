#include "bench/traversal_cost.h"

#include <set>
#include <utility>

#include "bench/frames.h"
#include "format/selection.h"
#include "format/system/result_macros.h"

namespace splatlas {
namespace {

/// Pictures of one turn, for comparison.
struct Pictures {
  std::array<std::vector<float>, kMethods.size()> of;

  std::vector<float>& operator[](Method method) { return of[static_cast<std::size_t>(method)]; }
  /// Number of values whose bits differ from those of full traversal.
  [[nodiscard]] std::uint64_t bits_differ() const {
    std::uint64_t differ = 0;
    for (std::size_t method = 1; method < of.size(); ++method)
      differ += splatlas::bits_differ(of[method], of[0]);
    return differ;
  }
};

std::vector<Elapsed> stages_of(const Elapsed& traversal, const Elapsed& rasterize, const Elapsed& sheets,
                               const Elapsed& resolve) {
  return {traversal, rasterize, sheets, resolve, traversal + rasterize + sheets + resolve};
}

/// The three methods to draw the frames of one figure.
class MethodRunner {
 public:
  MethodRunner(std::shared_ptr<const Atlas> atlas, const VoxelModel& model, const Figure& figure,
               const TraversalEffort& effort, unsigned threads)
      : figure_(figure),
        effort_(effort),
        full_(atlas, model, threads),
        fresh_(atlas, {.threads = threads}),
        turning_(std::move(atlas), {.threads = threads}) {}

  [[nodiscard]] int turns() const { return effort_.frames * effort_.repeats; }

  /// Selects, and draws one frame per principal axis with both renderers, so that everything is decoded.
  Result<void> prepare() {
    SPLATLAS_ASSIGN_OR_RETURN(selection_, select(figure_.selection, turning_.atlas().graph()));
    full_.select(selection_);
    SPLATLAS_RETURN_IF_ERROR(fresh_.select(selection_));
    SPLATLAS_RETURN_IF_ERROR(turning_.select(selection_));
    RenderOptions unlit;  // lighting that no frame keeps
    unlit.hybrid_shading = false;
    std::set<Axis> prepared;
    for (int turn = 0; turn < turns(); ++turn) {
      SPLATLAS_ASSIGN_OR_RETURN(const ParallelView view,
                                parallel_view(camera(turn), options_.size, turning_.atlas().display()));
      if (!prepared.insert(factorise(view, turning_.atlas().grid()).principal).second) continue;
      SPLATLAS_RETURN_IF_ERROR(fresh_.render(camera(turn), unlit));
      SPLATLAS_RETURN_IF_ERROR(turning_.render(camera(turn), unlit));
    }
    return {};
  }

  Result<std::vector<Elapsed>> draw(Method method, int turn) {
    SPLATLAS_ASSIGN_OR_RETURN(const std::vector<Elapsed> stages,
                              method == Method::kFullTraversal ? draw_full(turn) : draw_player(method, turn));
    if (++drawn_ % kMethods.size() == 0) bits_differ_ += pictures_.bits_differ();
    return stages;
  }

  [[nodiscard]] std::uint64_t bits_differ() const { return bits_differ_; }
  [[nodiscard]] const RenderStats& stats() const { return turning_.stats(); }

 private:
  [[nodiscard]] Camera camera(int turn) const { return turned(figure_.camera, turn, effort_.frames); }

  Result<std::vector<Elapsed>> draw_full(int turn) {
    SPLATLAS_ASSIGN_OR_RETURN(FullTraversal::Frame frame, full_.render(camera(turn), options_));
    pictures_[Method::kFullTraversal] = std::move(frame.picture.rgba);
    return stages_of(frame.traversal, frame.drawn.rasterize, frame.drawn.sheets, frame.drawn.resolve);
  }

  Result<std::vector<Elapsed>> draw_player(Method method, int turn) {
    Renderer& renderer = method == Method::kTurning ? turning_ : fresh_;
    Elapsed selecting;
    if (method == Method::kNewSelection) {
      Stopwatch watch;
      SPLATLAS_RETURN_IF_ERROR(renderer.select(selection_));
      selecting = watch.lap();
    }
    SPLATLAS_ASSIGN_OR_RETURN(Picture picture, renderer.render(camera(turn), options_));
    pictures_[method] = std::move(picture.rgba);
    const RenderStats& stats = renderer.stats();
    return stages_of(selecting + stats.traversal, stats.rasterize, stats.sheets, stats.resolve);
  }

  const Figure& figure_;
  TraversalEffort effort_;
  FullTraversal full_;
  Renderer fresh_, turning_;
  RenderOptions options_;
  Selection selection_;
  Pictures pictures_;
  std::size_t drawn_ = 0;
  std::uint64_t bits_differ_ = 0;
};

}  // namespace

const char* name_of(Method method) {
  switch (method) {
    case Method::kFullTraversal: return "full traversal";
    case Method::kNewSelection: return "new selection";
    case Method::kTurning: break;
  }
  return "turning";
}

Result<TraversalCost> measure_traversal(std::shared_ptr<const Atlas> atlas, const VoxelModel& model,
                                        const Figure& figure, unsigned threads,
                                        const TraversalEffort& effort) {
  MethodRunner methods(std::move(atlas), model, figure, effort, threads);
  SPLATLAS_RETURN_IF_ERROR(methods.prepare());
  std::vector<Contender> contenders;
  for (const Method method : kMethods) {
    contenders.emplace_back([&methods, method](int turn) { return methods.draw(method, turn); });
  }
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<StageTimes> times,
                            measure_interleaved(contenders, methods.turns()));

  TraversalCost cost;
  cost.stats = methods.stats();
  cost.bits_differ = methods.bits_differ();
  constexpr auto kFrame = static_cast<std::size_t>(Stage::kFrame);
  for (std::size_t method = 0; method < kMethods.size(); ++method) {
    for (std::size_t stage = 0; stage < kStages; ++stage) {
      cost.medians[method][stage] = median(times[method][stage]);
    }
    cost.ratios[method] = median_ratio(times[method][kFrame], times[0][kFrame], effort.frames);
  }
  return cost;
}

void append_stage_rows(const std::string& figure, unsigned threads, const TraversalCost& cost, Table& table) {
  for (const Method method : kMethods) {
    Row row{{"figure", figure}, {"threads", threads}, {"method", name_of(method)}};
    const auto add = [&](const std::string& stage, Stage number) {
      row[stage + "_ms"] = cost.of(method, number).wall_ms;
      row[stage + "_cpu"] = cost.of(method, number).cpu_ms;
    };
    add("traversal", Stage::kTraversal);
    add("raster", Stage::kRasterize);
    add("sheets", Stage::kSheets);
    add("resolve", Stage::kResolve);
    add("frame", Stage::kFrame);
    table.rows.push_back(row);
  }
}

}  // namespace splatlas

// Bench `limit`: distance of the renderer from the limit of the machine.
#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "bench/bench.h"
#include "bench/experiments/dense_kernel.h"
#include "bench/experiments/packed_spans.h"
#include "bench/measure/measure.h"
#include "bench/scenes/atlases.h"
#include "bench/scenes/participants.h"
#include "format/result_macros.h"
#include "player/render/sheets/spans/build_spans.h"

namespace splatlas {
namespace {

struct Effort {
  std::vector<int> sizes{512, 1024};
  int frames = 7, repeats = 3;
  int thread_repeats = 12;
};

/// White volumes have one colour to composite, coloured ones three.
constexpr std::array kAppearances{ErrorAppearance{"thin", "profile=thin,opacity=0.01,color=#ffffff"},
                                  ErrorAppearance{"soft", "opacity=0.3,color=#ffffff"},
                                  ErrorAppearance{"thin, coloured", "profile=thin,opacity=0.01"}};

/// One scene at one size, normal quality, one thread, without early ray termination: all three composite as
/// many samples onto sheets of equal size. Each turn is a view.
class LimitTask {
 public:
  /// Must outlive this.
  explicit LimitTask(const ErrorTask& task) : task_(task) {
    options_.size = task.size;
    options_.hybrid_shading = false;
    options_.termination_threshold = 0.0f;
  }

  /// Prepares spans, packed voxels and dense volume for every axis of the turns, and draws once with each.
  Result<void> prepare() {
    for (int turn = 0; turn < task_.turns(); ++turn) {
      SPLATLAS_ASSIGN_OR_RETURN(const Frame frame, frame_of(turn));
      if (axes_.contains(frame.shear.principal)) continue;
      const Atlas& atlas = *task_.atlas;
      SPLATLAS_ASSIGN_OR_RETURN(
          const DecodedVolumes decoded,
          decode_volumes(task_.atlas, task_.model.selection, frame.shear.principal, pool_));
      AxisModels& models = axes_[frame.shear.principal];
      models.builder.build({*decoded.runs, decoded.plan, *decoded.appearances, atlas.classes(), atlas.grid(),
                            *decoded.cache, false},
                           pool_);
      SPLATLAS_RETURN_IF_ERROR(draw(turn));
      const SheetWindow& window = buffers_.sheet.window;
      models.packed = pack_spans(models.spans(), frame.shear, window);
      const auto per_slice = static_cast<std::uint64_t>(window.columns * window.rows);
      const std::uint64_t samples = models.spans().voxels * static_cast<std::uint64_t>(parts());
      models.dense =
          DenseVolume::fog(window.columns, window.rows,
                           static_cast<std::int64_t>((samples + per_slice - 1) / per_slice), planes());
      SPLATLAS_RETURN_IF_ERROR(draw_packed(turn));
      SPLATLAS_RETURN_IF_ERROR(draw_dense(turn));
    }
    return {};
  }

  /// Frame, rasterising, sheets, resolve, as in the player.
  Result<std::vector<Elapsed>> draw(int turn) {
    SPLATLAS_ASSIGN_OR_RETURN(const Frame frame, frame_of(turn));
    const SpanModel& spans = axes_.at(frame.shear.principal).spans();
    const Lighting lighting(frame.view);
    Stopwatch watch;
    SPLATLAS_ASSIGN_OR_RETURN(const RenderStats drawn,
                              draw_frame({.surfaces = {},
                                          .view = {frame.view},
                                          .grid = task_.atlas->grid(),
                                          .lighting = lighting,
                                          .options = options_,
                                          .overrides = {}},
                                         spans, frame.shear, buffers_, picture_, pool_));
    const Elapsed elapsed = watch.lap();
    if (drawn.voxels_visited != spans.voxels)
      return fail(ErrorCode::kFailed, "a part of the scene lies outside of the picture");
    return std::vector{elapsed, drawn.rasterize, drawn.sheets, drawn.resolve};
  }

  /// Sheets of the packed voxels.
  Result<std::vector<Elapsed>> draw_packed(int turn) {
    SPLATLAS_ASSIGN_OR_RETURN(const Frame frame, frame_of(turn));
    const PackedSpans& packed = axes_.at(frame.shear.principal).packed;
    FragmentList none;
    none.first_of_row.assign(static_cast<std::size_t>(options_.size.height) + 1, 0);
    Stopwatch watch;
    no_fragments_.build(none, packed.shear, packed.window, options_.size, task_.atlas->grid(), pool_);
    const std::uint64_t voxels = render_sheets(SheetSpans(packed.model), packed.shear, packed.window,
                                               best_kernels(), 0, {}, no_fragments_, packed_sheet_, pool_);
    const Elapsed elapsed = watch.lap();
    if (voxels != packed.model.voxels)
      return fail(ErrorCode::kFailed, "a part of the packed voxels lies outside of the sheet");
    return std::vector{elapsed};
  }

  /// The dense kernel.
  Result<std::vector<Elapsed>> draw_dense(int turn) {
    SPLATLAS_ASSIGN_OR_RETURN(const Frame frame, frame_of(turn));
    dense_sheet_.scale = scale();
    Stopwatch watch;
    composite_dense(axes_.at(frame.shear.principal).dense, dense_sheet_);
    return std::vector{watch.lap()};
  }

  /// Sheet pixels per voxel of the latest draw().
  [[nodiscard]] int scale() const { return buffers_.sheet.window.scale; }
  /// Slabs per slice of the latest draw().
  [[nodiscard]] int parts() const { return buffers_.sheet.window.parts; }
  /// Samples of the scene: voxels times sheet pixels per voxel times slabs per slice. Equal for all turns.
  [[nodiscard]] std::uint64_t scene_samples() const {
    return spans().voxels * static_cast<std::uint64_t>(scale() * scale() * parts());
  }
  /// Share of span blocks that selected voxels fill.
  [[nodiscard]] double fill() const {
    std::uint64_t blocks = 0;
    for (const SliceSpans& slice : spans().slices) {
      for (const Span& span : slice.spans) blocks += span.blocks;
    }
    return static_cast<double>(spans().voxels) / static_cast<double>(blocks << kBlockBits);
  }
  /// Samples of the dense volume of a turn, rounded up to whole slices.
  [[nodiscard]] Result<std::uint64_t> dense_samples(int turn) const {
    SPLATLAS_ASSIGN_OR_RETURN(const Frame frame, frame_of(turn));
    return samples(axes_.at(frame.shear.principal).dense, scale());
  }
  /// Composited colours and opacity.
  [[nodiscard]] int planes() const { return 1 + spans().emissions; }

 private:
  struct Frame {
    ParallelView view;
    Shear shear;
  };
  struct AxisModels {
    SpanBuilder builder;
    PackedSpans packed;
    DenseVolume dense;
    [[nodiscard]] const SpanModel& spans() const { return builder.model(); }
  };
  [[nodiscard]] Result<Frame> frame_of(int turn) const {
    SPLATLAS_ASSIGN_OR_RETURN(const ParallelView view, task_.view(task_.camera(turn)));
    return Frame{view, factorise(view, task_.atlas->grid())};
  }
  [[nodiscard]] const SpanModel& spans() const { return axes_.begin()->second.spans(); }

  const ErrorTask& task_;
  RenderOptions options_;
  ThreadPool pool_{1};
  std::map<Axis, AxisModels> axes_;
  FrameBuffers buffers_;
  Picture picture_;
  FragmentOrder no_fragments_;
  SheetImage packed_sheet_;
  DenseSheet dense_sheet_;
};

/// Cost of a scene: minimum over repeats of each frame, median over frames.
struct LimitCost {
  Elapsed frame = {}, rasterize = {}, sheets = {}, resolve = {}, packed = {};
  double dense_ns = 0;         ///< per sample
  double over_packed = 0;      ///< sheets over those of packed voxels
  Elapsed one = {}, two = {};  ///< frames of one and two threads
  double two_thread_speedup = 0;
};

Result<LimitCost> measure(LimitTask& limit, const ErrorTask& task) {
  SPLATLAS_RETURN_IF_ERROR(limit.prepare());
  const std::vector<Contender> contenders{[&](int turn) { return limit.draw(turn); },
                                          [&](int turn) { return limit.draw_packed(turn); },
                                          [&](int turn) { return limit.draw_dense(turn); }};
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<StageTimes> times,
                            measure_interleaved(contenders, task.turns()));
  const auto best = [&](std::size_t contender, std::size_t stage) {
    return best_of_repeats(times[contender][stage], task.frames);
  };
  const auto sheets = best(0, 2), packed = best(1, 0), dense = best(2, 0);
  LimitCost cost{.frame = median(best(0, 0)),
                 .rasterize = median(best(0, 1)),
                 .sheets = median(sheets),
                 .resolve = median(best(0, 3)),
                 .packed = median(packed),
                 .over_packed = median_ratio(sheets, packed).cpu_ms};
  std::vector<double> dense_ns;
  for (int frame = 0; frame < task.frames; ++frame) {
    SPLATLAS_ASSIGN_OR_RETURN(const std::uint64_t samples, limit.dense_samples(frame));
    dense_ns.push_back(1e6 * dense[static_cast<std::size_t>(frame)].cpu_ms / static_cast<double>(samples));
  }
  cost.dense_ns = median(dense_ns);
  return cost;
}

/// Speedup of two threads by the wall clock. Other load takes a core from the second thread: many more
/// repeats.
Result<void> measure_threads(const ErrorTask& task, int repeats, LimitCost& cost) {
  constexpr std::array kNormal{NamedQuality{"normal", Quality::kNormal}};
  std::vector<Participant> participants;
  for (const unsigned threads : {1u, 2u})
    SPLATLAS_RETURN_IF_ERROR(add_ours(task, Classification::kBefore, threads, participants, kNormal));
  std::vector<Contender> contenders;
  for (const Participant& participant : participants)
    contenders.push_back(timed([&](int turn) { return participant.draw(task.camera(turn)); }));
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<StageTimes> times,
                            measure_interleaved(contenders, task.frames * repeats));
  const auto one = best_of_repeats(times[0][0], task.frames);
  const auto two = best_of_repeats(times[1][0], task.frames);
  cost.one = median(one);
  cost.two = median(two);
  cost.two_thread_speedup = median_ratio(one, two).wall_ms;
  return {};
}

Row row_of(const LimitTask& task, const LimitCost& cost) {
  const auto samples = static_cast<double>(task.scene_samples());
  const double ours_ns = 1e6 * cost.sheets.cpu_ms / samples;
  const Elapsed& frame = cost.frame;
  const double staged = cost.rasterize.cpu_ms + cost.sheets.cpu_ms + cost.resolve.cpu_ms;
  return {{"planes", task.planes()},
          {"pixels_per_voxel", task.scale() * task.scale()},
          {"samples_m", 1e-6 * samples},
          {"fill", task.fill()},
          {"frame_cpu", frame.cpu_ms},
          {"sheets_cpu", cost.sheets.cpu_ms},
          {"resolve_cpu", cost.resolve.cpu_ms},
          {"other_share", std::max(0.0, 1 - staged / frame.cpu_ms)},
          {"ns", ours_ns},
          {"dense_ns", cost.dense_ns},
          {"over_dense", ours_ns / cost.dense_ns},
          {"packed_cpu", cost.packed.cpu_ms},
          {"over_packed", cost.over_packed},
          {"one_wall", cost.one.wall_ms},
          {"two_wall", cost.two.wall_ms},
          {"speedup", cost.two_thread_speedup}};
}

}  // namespace

Result<Report> run_limit_bench(const BenchOptions& options) {
  Report report;
  SPLATLAS_ASSIGN_OR_RETURN(const std::shared_ptr<const Atlas> atlas, open_colin27(options));
  SPLATLAS_ASSIGN_OR_RETURN(const AtlasContent content, atlas->read_all());
  const Effort effort = options.quick ? Effort{.sizes = {512}, .frames = 3, .thread_repeats = 6} : Effort{};
  Table table{
      "limit",
      "Composited samples against the limit of the machine, parallel projection, normal quality",
      {"ns: CPU time of one thread in sheets, per absorbing voxel, slab and sheet pixel, without early ray "
       "termination",
       "dense_ns: per sample of a plain SIMD loop (bilinear, under, no exponential) over a dense volume of "
       "as many samples, planes and pixels of the sheet",
       "packed_cpu: sheets of the same voxels packed into one array: over_packed - 1 is the cost of "
       "traversal",
       "fill: share of the span blocks of 16 voxels that selected voxels fill",
       "other_share: share of CPU time outside sheets, resolve and rasterising",
       "speedup: one thread over two, wall clock, with early ray termination",
       "times: minimum over repeats of a frame; medians over frames"}};
  for (const ErrorScene& scene : error_scenes()) {
    for (const ErrorAppearance& appearance : kAppearances) {
      SPLATLAS_ASSIGN_OR_RETURN(const ErrorModel model, error_model(content, scene, appearance));
      for (const int size : effort.sizes) {
        options.tell(fmt::format("{}, {}, {}x{}", scene.name, appearance.name, size, size));
        const ErrorTask task{atlas, model, {size, size}, effort.frames, effort.repeats};
        LimitTask limit(task);
        SPLATLAS_ASSIGN_OR_RETURN(LimitCost cost, measure(limit, task));
        SPLATLAS_RETURN_IF_ERROR(measure_threads(task, effort.thread_repeats, cost));
        Row& row = table.rows.emplace_back(
            Row{{"scene", scene.name}, {"transfer", appearance.name}, {"size", size}});
        row.update(row_of(limit, cost));
        raise(report.summary, "over_dense", row["over_dense"].get<double>());
        lower(report.summary, "two_thread_speedup", cost.two_thread_speedup);
        raise(report.summary, "traversal_overhead", cost.over_packed - 1);
        raise(report.summary, "other_share_max", row["other_share"].get<double>());
      }
    }
  }
  report.tables.push_back(std::move(table));
  return report;
}

}  // namespace splatlas

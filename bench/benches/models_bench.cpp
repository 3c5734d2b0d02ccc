// Bench `models`: cost of other models (paper, section 5): run models per level of the tree, and octrees over
// the classes.
#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "bench/bench.h"
#include "bench/experiments/class_octree.h"
#include "bench/experiments/level_runs.h"
#include "bench/measure/frames.h"
#include "bench/measure/measure.h"
#include "bench/scenes/atlases.h"
#include "format/codec/chunk_codec.h"
#include "format/codec/run_codec.h"
#include "format/result_macros.h"
#include "player/render/sheets/spans/build_spans.h"
#include "player/render/sheets/spans/span_writer.h"
#include "player/renderer.h"

namespace splatlas {
namespace {

constexpr int kZstdLevel = 12;
constexpr std::int64_t kBrickSide = 8;

constexpr std::array kScenes{
    BenchScene{"head", "Head:volume(color=#ffffff)"},
    BenchScene{"brain", "Brain:volume(color=#ffffff) - \"Rest of brain\""},
    BenchScene{"brain, own colours", "Brain:volume - \"Rest of brain\""},
    BenchScene{"left", "\"Left hemisphere\":volume(color=#ffffff)"},
    BenchScene{"lobe", "\"Frontal lobe\":volume(color=#ffffff)"},
    BenchScene{"scattered", "*_Inf_*:volume(color=#ffffff) + *_Mid_*:volume(color=#ffffff)"},
    BenchScene{"gyrus", "Precentral_L:volume(color=#ffffff)"},
    BenchScene{"one", "Hippocampus_L:volume(color=#ffffff) + Amygdala_L:volume(color=#ffffff)"}};

/// Models that yield the runs of a selection.
enum Model : std::size_t { kRuns, kLevels, kVoxelOctree, kBrickOctree };
constexpr std::array kModelNames{"one run model", "run models by level", "octree to voxels",
                                 "octree to bricks of 8"};

/// The atlas in every model, decoded.
struct Models {
  std::shared_ptr<const Atlas> atlas;
  ClassCache classes;  ///< runs of every class along every axis, and values
  LevelRuns levels;
  ClassOctree voxel_octree, brick_octree;

  static Result<Models> make(std::shared_ptr<const Atlas> atlas, ThreadPool& pool) {
    ClassCache cache(atlas);
    std::vector<ClassId> all;
    for (ClassId c = 1; c < atlas->classes().size(); ++c) all.push_back(c);
    for (const Axis axis : kAxes) SPLATLAS_RETURN_IF_ERROR(cache.require(all, axis, pool));
    SPLATLAS_ASSIGN_OR_RETURN(const AtlasContent content, atlas->read_all());
    SPLATLAS_ASSIGN_OR_RETURN(LevelRuns levels, LevelRuns::build(*atlas));
    const Index3 size = atlas->grid().size;
    return Models{std::move(atlas), std::move(cache), std::move(levels),
                  ClassOctree(content.class_volume, size, 1),
                  ClassOctree(content.class_volume, size, kBrickSide)};
  }
};

/// The first frame of a selection, unlit; only the retrieval of runs differs. The run model is traversed as
/// in the player; other models return lists of runs. The rest is the code of the player, except for the loop
/// over slices, as SpanBuilder knows no other model. Pictures are compared with those of the player.
class ModelFrames {
 public:
  ModelFrames(const Models& models, ThreadPool& pool)
      : models_(models), pool_(pool), appearances_(*models.atlas), player_(models.atlas, {.threads = 1}) {}

  Result<void> select(std::string_view text) {
    SPLATLAS_ASSIGN_OR_RETURN(const Selection selection, Selection::parse(text, models_.atlas->graph()));
    plan_ = models_.atlas->tree().plan(selection);
    appearances_.select(plan_, selection);
    players_camera_.reset();
    return player_.select(selection);
  }

  /// Stages of draw(): retrieval of runs from other models; span build (includes retrieval for the run
  /// model); both; drawing; all.
  enum Stage : std::size_t { kFind, kSpans, kTraversal, kDraw, kFrame };
  /// Draws a turn of an oblique view, 512x512, through one model. Every turn must use all models.
  Result<std::vector<Elapsed>> draw(Model model, int turn, int frames) {
    const Camera camera = turned(oblique_camera(), turn, frames);
    const Atlas& atlas = *models_.atlas;
    SPLATLAS_ASSIGN_OR_RETURN(const ParallelView view, parallel_view(camera, kOptions.size, atlas.display()));
    const Shear shear = factorise(view, atlas.grid());
    const Lighting lighting(view);

    Stopwatch watch;
    const std::vector<std::uint32_t> draws =
        shared_draws_by_class(plan_, appearances_.appearances(), atlas.classes().size());
    const SelectedRuns selected(plan_, atlas.classes(), models_.classes, shear.principal);
    const FoundRuns found = find(model, draws, shear.principal);
    const Elapsed finding = watch.lap();
    if (model == kRuns) {
      build_spans(selected, [&](std::int64_t slice, const auto& take) {
        selected.for_each(slice, [&](const ClassRun& run, std::uint32_t) {
          take({run.row, run.start, run.length, draws[run.id]});
        });
      });
    } else {
      build_spans(selected, [&](std::int64_t slice, const auto& take) {
        for (const FoundRun& run : found.slice(slice)) take(run);
      });
    }
    const Elapsed building = watch.lap();
    SPLATLAS_RETURN_IF_ERROR(draw_frame({.surfaces = {},
                                         .view = {view},
                                         .grid = atlas.grid(),
                                         .lighting = lighting,
                                         .options = kOptions,
                                         .overrides = {}},
                                        spans_, shear, buffers_, picture_, pool_));
    const Elapsed drawing = watch.lap();
    SPLATLAS_RETURN_IF_ERROR(compare(camera));
    const Elapsed traversal = finding + building;
    return std::vector<Elapsed>{finding, building, traversal, drawing, traversal + drawing};
  }

  /// Of the latest frame: runs (adjacent ones of equal appearance count once), and voxels with extinction.
  [[nodiscard]] std::uint64_t runs() const { return runs_; }
  [[nodiscard]] std::uint64_t voxels() const { return spans_.voxels; }
  /// Number of values whose bits differ from the pictures of the player.
  [[nodiscard]] std::uint64_t bits_differ() const { return bits_differ_; }

 private:
  /// Unlit, as only the lowest level separates boundaries.
  static constexpr RenderOptions kOptions{.size = {512, 512}, .hybrid_shading = false};

  FoundRuns find(Model model, std::span<const std::uint32_t> draws, Axis axis) const {
    if (model == kRuns) return {};
    RunCollector runs(drawn_box(plan_, models_.atlas->classes()), axis);
    if (model == kLevels) models_.levels.collect(draws, axis, runs);
    if (model == kVoxelOctree) models_.voxel_octree.collect(draws, runs);
    if (model == kBrickOctree) models_.brick_octree.collect(draws, runs);
    return runs.finish();
  }

  template <typename Walk>
  void build_spans(const SelectedRuns& selected, const Walk& walk) {
    set_box(selected, spans_);
    set_appearances(plan_, appearances_.appearances(), models_.atlas->classes(), spans_);
    spans_.slices.resize(static_cast<std::size_t>(selected.slices()));  // slices keep their memory
    for (std::size_t n = 0; n < spans_.slices.size(); ++n)
      spans_.slices[n].number = spans_.slice_first + static_cast<std::int64_t>(n);
    spans_.voxels = 0;
    runs_ = 0;
    for (std::int64_t slice = selected.box().first[2]; slice <= selected.box().last[2]; ++slice)
      build_slice(slice, walk);
    for (const SliceSpans& slice : spans_.slices) spans_.voxels += slice.voxels;
  }

  /// Writes the spans of one slice as SpanBuilder does. Adjacent runs of equal appearance share one look-up.
  template <typename Walk>
  void build_slice(std::int64_t slice, const Walk& walk) {
    const Grid& grid = models_.atlas->grid();
    const ScanOrder scan = ScanOrder::of(spans_.axis);
    const std::array<std::size_t, 3> step{1, static_cast<std::size_t>(grid.size[0]),
                                          static_cast<std::size_t>(grid.size[0] * grid.size[1])};
    SpanWriter writer(spans_.emissions, spans_.slices[static_cast<std::size_t>(slice - spans_.slice_first)]);
    FoundRun whole;
    const auto write = [&] {
      if (whole.length == 0) return;
      const VolumeAppearance& appearance = appearances_.appearances()[whole.draw];
      const std::size_t voxel = static_cast<std::size_t>(slice) * step[scan.slice_axis] +
                                whole.row * step[scan.row_axis] + whole.start * step[scan.scan_axis];
      writer.add(whole.start, whole.length);
      appearance.look_up(models_.classes.values(), voxel, step[scan.scan_axis], whole.length,
                         writer.extinctions(whole.start), writer.whites(whole.start));
      writer.color(whole.start, whole.length, appearance.color);
      ++runs_;
    };
    walk(slice, [&](const FoundRun& run) {
      if (run.row == whole.row && run.start == whole.start + whole.length && run.draw == whole.draw) {
        whole.length += run.length;
        return;
      }
      write();
      if (run.row != whole.row) writer.end_row(whole.row);
      whole = run;
    });
    write();
    writer.end_row(whole.row);
    writer.finish();
  }

  Result<void> compare(const Camera& camera) {
    if (!players_camera_ || players_camera_->azimuth_deg != camera.azimuth_deg) {
      SPLATLAS_RETURN_IF_ERROR(player_.render(camera, kOptions, players_frame_));
      players_camera_ = camera;
    }
    bits_differ_ += splatlas::bits_differ(picture_.rgba, players_frame_.picture.rgba);
    return {};
  }

  const Models& models_;
  ThreadPool& pool_;
  VolumeAppearances appearances_;
  DrawPlan plan_;
  SpanModel spans_;
  FrameBuffers buffers_;
  Picture picture_;
  Renderer player_;
  Frame players_frame_;
  std::optional<Camera> players_camera_;
  std::uint64_t runs_ = 0, bits_differ_ = 0;
};

/// Compressed size of a file representation.
std::uint64_t compressed(std::span<const std::byte> bytes) {
  return encode_chunk(bytes, kZstdLevel).bytes.size();
}

Result<Table> memory_table(const Models& models) {
  Table table{
      "memory",
      "Size of the models, all three axes",
      {"bytes: in memory; per_voxel: of the grid; zstd: run lists as an atlas file codes them, an octree",
       "as columns of its arrays, in one chunk each"}};
  const auto voxels = static_cast<double>(models.atlas->grid().voxels());
  const auto add = [&](Model model, const char* parts, std::uint64_t count, std::uint64_t bytes,
                       std::uint64_t zstd) {
    table.rows.push_back({{"model", kModelNames[model]},
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
  add(kRuns, "runs", runs, runs * sizeof(ClassRun), zstd);
  add(kLevels, "runs", level_runs, level_runs * sizeof(Run), level_zstd);
  const ClassOctree& fine = models.voxel_octree;
  const ClassOctree& coarse = models.brick_octree;
  add(kVoxelOctree, "nodes", fine.nodes(), fine.bytes(), compressed(fine.encoded()));
  add(kBrickOctree, "nodes", coarse.nodes(), coarse.bytes(), compressed(coarse.encoded()));
  return table;
}

/// Frame times of a scene relative to the run model, per model.
using Ratios = std::array<double, kModelNames.size()>;

Result<Ratios> measure_scene(ModelFrames& task, const BenchScene& scene, bool quick, Table& table,
                             Report& report) {
  const int frames = quick ? 3 : 7;
  const int repeats = quick ? 1 : 5;
  SPLATLAS_RETURN_IF_ERROR(task.select(scene.selection));
  std::vector<Contender> contenders;
  for (const Model model : {kRuns, kLevels, kVoxelOctree, kBrickOctree}) {
    contenders.emplace_back([&task, model, frames](int turn) { return task.draw(model, turn, frames); });
  }
  SPLATLAS_RETURN_IF_ERROR(measure_interleaved(contenders, 1));  // fresh memory
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<StageTimes> times,
                            measure_interleaved(contenders, frames * repeats));
  Ratios ratios{};
  for (std::size_t n = 0; n < kModelNames.size(); ++n) {
    const auto ms = [&](std::size_t stage) { return median(times[n][stage]).cpu_ms; };
    ratios[n] = median_ratio(times[n][ModelFrames::kFrame], times[0][ModelFrames::kFrame], frames).cpu_ms;
    table.rows.push_back(
        {{"scene", scene.name},
         {"model", kModelNames[n]},
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
  SPLATLAS_ASSIGN_OR_RETURN(report.tables.emplace_back(), memory_table(models));

  Table table{
      "time",
      "The first frame of a selection through each model, 512x512, one thread",
      {"find: runs of other models; spans: from runs to spans, retrieval included for the run model; draw:",
       "from spans to the picture; ratios: CPU time over that of one run model; traversal is find and spans",
       "later frames of a selection draw only, and the same spans with every model",
       "pictures are the same, bit for bit"}};
  std::array<std::vector<double>, kModelNames.size()> ratios;
  for (const BenchScene& scene : kScenes) {
    options.tell(scene.name);
    ModelFrames task(models, pool);
    SPLATLAS_ASSIGN_OR_RETURN(const Ratios measured,
                              measure_scene(task, scene, options.quick, table, report));
    for (std::size_t n = 0; n < measured.size(); ++n) ratios[n].push_back(measured[n]);
  }
  report.tables.push_back(std::move(table));
  const auto ratio = [&](Model model) { return median(ratios[model]); };
  // The better of the two octrees.
  report.summary["octree_over_runs_time_median"] = std::min(ratio(kVoxelOctree), ratio(kBrickOctree));
  report.summary["levels_over_runs_time_median"] = ratio(kLevels);
  return report;
}

}  // namespace splatlas

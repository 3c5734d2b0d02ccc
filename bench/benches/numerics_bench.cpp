// Bench `numerics`: bias, popping, ripple, threads, stress inputs, orders of convergence.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "bench/bench.h"
#include "bench/experiments/axis_switch.h"
#include "bench/experiments/convergence.h"
#include "bench/experiments/draw_stress.h"
#include "bench/experiments/ripple.h"
#include "bench/scenes/atlases.h"
#include "bench/scenes/participants.h"
#include "format/result_macros.h"

namespace splatlas {
namespace {

/// The default quality, reported in the summary.
constexpr const char* kQuoted = "normal";

struct Effort {
  int size = 512;
  int views_compared = 2;
  int ripple_views = 120;
  int thread_views = 3;
  std::uint32_t random_scenes = 400;
};

constexpr Effort kQuick{
    .size = 256, .views_compared = 1, .ripple_views = 20, .thread_views = 1, .random_scenes = 60};

bool is_quoted(const RendererCost& cost) {
  return cost.renderer == "splatlas" && cost.setting == kQuoted;
}

Result<reference::PictureDifference> pop_of(const Participant& participant, const AxisSwitch& axis_switch) {
  SPLATLAS_RETURN_IF_ERROR(participant.draw(axis_switch.before));
  const Picture before = participant.picture();
  SPLATLAS_RETURN_IF_ERROR(participant.draw(axis_switch.after));
  return reference::difference(before, participant.picture());
}

/// Splatlas at every quality and VolPack in parallel projection: errors and pops.
Result<void> measure_pictures(const std::shared_ptr<const Atlas>& atlas, const Effort& effort,
                              const BenchOptions& options, Report& report) {
  SPLATLAS_ASSIGN_OR_RETURN(const AtlasContent content, atlas->read_all());
  Table bias{
      "bias",
      "Mean signed error, parallel projection, grey values classified before interpolation",
      {"mean, rmse: against the truth in double precision, in 1/255 of linear light, all four channels",
       "bias_max: the largest absolute mean of our normal quality, soft and thin"}};
  Table pop{"pop",
            "Popping: differences across a switch of the principal axis, 2e-6 rad apart",
            {"between the axes named, at this elevation: RMS over what either picture shows, all four "
             "channels, in 1/255 of linear light; largest: of any pixel of any of them",
             "pop_soft, pop_hard: the largest of our normal quality"}};
  for (const ErrorScene& scene : error_scenes()) {
    for (const ErrorAppearance& appearance : error_appearances()) {
      options.tell(fmt::format("bias and popping: {}, {}", scene.name, appearance.name));
      SPLATLAS_ASSIGN_OR_RETURN(const ErrorModel model, error_model(content, scene, appearance));
      const ErrorTask task{atlas, model, {effort.size, effort.size}};
      std::vector<Participant> participants;
      SPLATLAS_RETURN_IF_ERROR(add_ours(task, Classification::kBefore, 2, participants));
      SPLATLAS_RETURN_IF_ERROR(add_volpack(task, OpacityRounding::kDown, participants));
      SPLATLAS_RETURN_IF_ERROR(compare(participants, task, Classification::kBefore, effort.views_compared));
      SPLATLAS_ASSIGN_OR_RETURN(const std::vector<AxisSwitch> switches,
                                axis_switches(model.camera, atlas->grid(), atlas->display()));
      const std::string appearance_name = appearance.name;
      for (const Participant& participant : participants) {
        const RendererCost& cost = participant.cost;
        const Row row{{"scene", scene.name},
                      {"transfer", appearance.name},
                      {"renderer", cost.renderer},
                      {"setting", cost.setting}};
        bias.rows.push_back(row);
        bias.rows.back().update({{"mean", 255 * cost.error.mean}, {"rmse", 255 * cost.error.rms}});
        if (is_quoted(cost) && appearance_name != "hard")
          raise(report.summary, "bias_max", 255 * std::abs(cost.error.mean));
        pop.rows.push_back(row);
        double largest = 0;
        for (const AxisSwitch& across : switches) {
          SPLATLAS_ASSIGN_OR_RETURN(const reference::PictureDifference d, pop_of(participant, across));
          pop.rows.back()[across.name] = 255 * d.rms;
          largest = std::max(largest, d.largest);
          if (is_quoted(cost) && appearance_name != "thin")
            raise(report.summary, "pop_" + appearance_name, 255 * d.rms);
        }
        pop.rows.back()["largest"] = 255 * largest;
      }
    }
  }
  report.tables.push_back(std::move(bias));
  report.tables.push_back(std::move(pop));
  return {};
}

Result<void> measure_ripples(const Effort& effort, Report& report) {
  Table table{
      "ripple",
      "Ripple: the largest error of a plate of constant density against its closed form",
      {"in 1/255 of linear light; any direction, zoom and shift below a voxel, opacities 0.03 and 0.3 a "
       "voxel",
       "faces_of_slices: rays enter and leave through faces that slices are parallel to, so that what is "
       "left is the sum of footprints (ripple: of our normal quality)",
       "side_faces: slices cut through the faces, whose slopes they sample (ripple_side_faces)"}};
  for (const CameraProjection projection : {CameraProjection::kParallel, CameraProjection::kPerspective}) {
    for (const NamedQuality& quality : kQualities) {
      SPLATLAS_ASSIGN_OR_RETURN(const Ripple ripple,
                                measure_ripple({quality.quality, projection, effort.ripple_views}));
      table.rows.push_back(
          {{"projection", projection == CameraProjection::kParallel ? "parallel" : "perspective"},
           {"setting", quality.name},
           {"faces_of_slices", 255 * ripple.faces_of_slices},
           {"pixels", ripple.pixels},
           {"side_faces", 255 * ripple.side_faces},
           {"side_pixels", ripple.side_pixels}});
      if (quality.name != std::string(kQuoted)) continue;
      raise(report.summary, "ripple", 255 * ripple.faces_of_slices);
      raise(report.summary, "ripple_side_faces", 255 * ripple.side_faces);
    }
  }
  report.tables.push_back(std::move(table));
  return {};
}

constexpr std::array kThreads{2u, 8u};  // compared with one
constexpr PictureSize kSize{253, 211};  // no multiple of bands, vectors or packets

constexpr const char* kVolume = "Brain:volume(opacity=0.3)";
constexpr const char* kHard = "Head:volume(profile=hard)";
constexpr const char* kSurfaces = "\"Left hemisphere\":surface(opacity=0.5) + Cerebellum:surface";
constexpr const char* kHybrid =
    "\"Left hemisphere\":both(opacity=0.4) + \"Right hemisphere\":surface(opacity=0.4) + Cerebellum:surface";

/// A mode of drawing.
struct DrawingMode {
  const char* name;
  const char* selection;
  CameraProjection projection = CameraProjection::kParallel;
  RenderOptions options{};
};
std::vector<DrawingMode> drawing_modes() {
  using enum CameraProjection;
  const auto with = [](Quality quality, Classification classification = Classification::kBefore) {
    return RenderOptions{.size = kSize, .quality = quality, .classification = classification};
  };
  RenderOptions edges = with(Quality::kNormal);
  edges.depth_cue = DepthCue::kEdges;
  return {
      {"draft", kVolume, kParallel, with(Quality::kDraft)},
      {"normal", kVolume, kParallel, with(Quality::kNormal)},
      {"high", kVolume, kParallel, with(Quality::kHigh)},
      {"hard, normal", kHard, kParallel, with(Quality::kNormal)},
      {"classified after", kHard, kParallel, with(Quality::kNormal, Classification::kAfter)},
      {"perspective", kVolume, kPerspective, with(Quality::kNormal)},
      {"perspective, post-classified", kHard, kPerspective, with(Quality::kNormal, Classification::kAfter)},
      {"surfaces", kSurfaces, kParallel, with(Quality::kNormal)},
      {"surfaces, perspective", kSurfaces, kPerspective, with(Quality::kNormal)},
      {"hybrid", kHybrid, kParallel, with(Quality::kNormal)},
      {"hybrid, perspective", kHybrid, kPerspective, with(Quality::kNormal)},
      {"depth cue", kHybrid, kParallel, edges},
      {"depth cue, perspective", kHybrid, kPerspective, edges},
  };
}

/// `views` views, 25 degrees apart.
Result<std::vector<Picture>> pictures_with(const std::shared_ptr<const Atlas>& atlas, const DrawingMode& mode,
                                           unsigned threads, int views) {
  Renderer renderer(atlas, {.threads = threads});
  SPLATLAS_ASSIGN_OR_RETURN(const Selection selection, Selection::parse(mode.selection, atlas->graph()));
  SPLATLAS_RETURN_IF_ERROR(renderer.select(selection));
  std::vector<Picture> pictures;
  for (int view = 0; view < views; ++view) {
    const Camera camera{
        .azimuth_deg = 31.0 + 25 * view, .elevation_deg = 19.0 + 12 * view, .projection = mode.projection};
    SPLATLAS_ASSIGN_OR_RETURN(Frame frame, renderer.render(camera, mode.options));
    pictures.push_back(std::move(frame.picture));
  }
  return pictures;
}

/// Number of values whose bits differ from those of one thread.
Result<std::uint64_t> thread_bits_differ(const std::shared_ptr<const Atlas>& atlas, const DrawingMode& mode,
                                         int views) {
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<Picture> expected, pictures_with(atlas, mode, 1, views));
  std::uint64_t differ = 0;
  for (const unsigned count : kThreads) {
    SPLATLAS_ASSIGN_OR_RETURN(const std::vector<Picture> pictures, pictures_with(atlas, mode, count, views));
    for (std::size_t n = 0; n < pictures.size(); ++n) {
      differ += bits_differ(pictures[n].rgba, expected[n].rgba);
    }
  }
  return differ;
}

Result<void> measure_threads(const std::shared_ptr<const Atlas>& atlas, const Effort& effort,
                             Report& report) {
  Table table{"threads", "Values whose bits differ between 1, 2 and 8 threads, Colin 27"};
  std::uint64_t all = 0;
  for (const DrawingMode& mode : drawing_modes()) {
    SPLATLAS_ASSIGN_OR_RETURN(const std::uint64_t differ,
                              thread_bits_differ(atlas, mode, effort.thread_views));
    table.rows.push_back({{"mode", mode.name}, {"views", effort.thread_views}, {"differ", differ}});
    all += differ;
  }
  report.summary["thread_bits_differ"] = all;
  if (all > 0) report.failures.push_back(fmt::format("{} values depend on the number of threads", all));
  report.tables.push_back(std::move(table));
  return {};
}

void measure_stress(const Effort& effort, const BenchOptions& options, Report& report) {
  Table table{
      "stress",
      "Stress inputs at every quality, in both projections, classified before and after interpolation",
      {"nan_pixels: pixels with a value that is not finite",
       "unphysical: pixels without 0 <= colour <= alpha <= 1, to 1e-5",
       "refused: pictures that ended with an error, as views that are not finite must"}};
  StressOutcome all;
  const auto add = [&](const std::string& name, const StressOutcome& outcome) {
    table.rows.push_back({{"input", name},
                          {"pictures", outcome.pictures},
                          {"refused", outcome.refused},
                          {"pixels", outcome.pixels},
                          {"nan_pixels", outcome.nan_pixels},
                          {"unphysical", outcome.unphysical}});
    all += outcome;
  };
  for (const StressKind& kind : stress_kinds()) {
    options.tell(fmt::format("stress: {}", kind.name));
    StressOutcome of_kind;
    for (const StressInput& input : kind.make()) of_kind += draw_stress(input);
    add(kind.name, of_kind);
  }
  add(fmt::format("{} random scenes", effort.random_scenes), draw_random_scenes(effort.random_scenes));
  report.summary["nan_pixels"] = all.nan_pixels;
  if (all.nan_pixels > 0) report.failures.push_back(fmt::format("{} pixels are not finite", all.nan_pixels));
  if (all.unphysical > 0)
    report.failures.push_back(fmt::format("{} pixels are brighter than their opacity", all.unphysical));
  report.tables.push_back(std::move(table));
}

Result<void> measure_orders(Report& report) {
  Table table{"order",
              "Orders of convergence on a smooth field: the slope of the error's logarithm",
              {"errors: RMS in 1/255, coarse to fine (grid: 1.5, 1, 0.75 mm; steps: 1, 2, 4, 8 to a slab)",
               "order_error_max: the largest deviation of an observed order from that of the method"}};
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<Convergence> rows, measure_convergence());
  for (const Convergence& row : rows) {
    const double off = std::abs(row.order() - row.theory);
    std::string errors;
    for (const double error : row.errors)
      errors += fmt::format("{}{:.5f}", errors.empty() ? "" : " ", 255 * error);
    table.rows.push_back({{"refined", row.refined},
                          {"renderer", row.renderer},
                          {"errors", errors},
                          {"order", row.order()},
                          {"theory", row.theory},
                          {"off", off}});
    raise(report.summary, "order_error_max", off);
  }
  report.tables.push_back(std::move(table));
  return {};
}

}  // namespace

Result<Report> run_numerics_bench(const BenchOptions& options) {
  Report report;
  const Effort effort = options.quick ? kQuick : Effort{};
  SPLATLAS_ASSIGN_OR_RETURN(const std::shared_ptr<const Atlas> atlas, open_colin27(options));
  SPLATLAS_RETURN_IF_ERROR(measure_pictures(atlas, effort, options, report));
  options.tell("ripple");
  SPLATLAS_RETURN_IF_ERROR(measure_ripples(effort, report));
  options.tell("threads");
  SPLATLAS_RETURN_IF_ERROR(measure_threads(atlas, effort, report));
  measure_stress(effort, options, report);
  options.tell("orders of convergence");
  SPLATLAS_RETURN_IF_ERROR(measure_orders(report));
  return report;
}

}  // namespace splatlas

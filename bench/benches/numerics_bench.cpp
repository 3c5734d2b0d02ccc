// Bench `numerics`: bias, popping, ripple, threads, random scenes, orders of convergence.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "bench/bench.h"
#include "bench/experiments/closed_forms.h"
#include "bench/scenes/atlases.h"
#include "bench/scenes/participants.h"
#include "format/result_macros.h"
#include "player/render/view/shear.h"
#include "tests/support/random_scene.h"

namespace splatlas {
namespace {

/// The default quality, reported in the summary.
constexpr const char* kQuoted = "normal";

struct Effort {
  int size = 512;
  int views_compared = 2;
  int ripple_views = 120;
  std::uint32_t random_scenes = 130;  // of each kind
};

constexpr Effort kQuick{.size = 256, .views_compared = 1, .ripple_views = 20, .random_scenes = 20};

bool is_quoted(const RendererCost& cost) {
  return cost.renderer == "splatlas" && cost.setting == kQuoted;
}

/// A direction of view midway between two principal axes, off all symmetries, where pictures may pop.
struct AxisSwitch {
  const char* axes;
  double azimuth_deg, elevation_deg;
  bool turns_azimuth;  ///< the angle that crosses it
};
/// Directions have components (sin az cos el, cos az cos el, sin el), up to signs: tan el = cos 20 degrees.
constexpr std::array kSwitches{AxisSwitch{"x/y 15", 45, 15, true}, AxisSwitch{"x/y 25", 45, 25, true},
                               AxisSwitch{"y/z 43", 20, 43.2191788937, false},
                               AxisSwitch{"x/z 43", 70, 43.2191788937, false}};

/// The difference between pictures 1e-6 rad to either side.
Result<reference::PictureDifference> pop_of(const Participant& participant, const ErrorTask& task,
                                            const AxisSwitch& across) {
  std::array<Picture, 2> pictures;
  std::array<Axis, 2> axes{};
  for (std::size_t side = 0; side < 2; ++side) {
    const double off = (side == 0 ? -1e-6 : 1e-6) * 180 / std::numbers::pi;
    Camera camera = task.model.camera;
    camera.azimuth_deg = across.azimuth_deg + (across.turns_azimuth ? off : 0);
    camera.elevation_deg = across.elevation_deg + (across.turns_azimuth ? 0 : off);
    SPLATLAS_ASSIGN_OR_RETURN(const ParallelView view, task.view(camera));
    axes[side] = factorise(view, task.atlas->grid()).principal;
    SPLATLAS_RETURN_IF_ERROR(participant.draw(camera));
    pictures[side] = participant.picture();
  }
  if (axes[0] == axes[1])
    return fail(ErrorCode::kFailed, fmt::format("{}: the principal axis does not switch", across.axes));
  return reference::difference(pictures[0], pictures[1]);
}

/// Splatlas at every quality and VolPack in parallel projection: errors and pops.
Result<void> measure_pictures(const std::shared_ptr<const Atlas>& atlas, const Effort& effort,
                              const BenchOptions& options, Report& report) {
  SPLATLAS_ASSIGN_OR_RETURN(const AtlasContent content, atlas->read_all());
  Table table{
      "pictures",
      "Mean signed error, and differences across switches of the principal axis, parallel projection",
      {"mean, rmse: against the truth in double precision, in 1/255 of linear light, all four channels",
       "x/y, y/z, x/z: RMS change between these axes, 2e-6 rad apart, at this elevation",
       "bias_max, pop_soft, pop_hard: the largest of our normal quality; bias of soft and thin"}};
  for (const ErrorScene& scene : error_scenes()) {
    for (const ErrorAppearance& appearance : error_appearances()) {
      options.tell(fmt::format("bias and popping: {}, {}", scene.name, appearance.name));
      SPLATLAS_ASSIGN_OR_RETURN(const ErrorModel model, error_model(content, scene, appearance));
      const ErrorTask task{atlas, model, {effort.size, effort.size}};
      std::vector<Participant> participants;
      SPLATLAS_RETURN_IF_ERROR(add_ours(task, Classification::kBefore, 2, participants));
      SPLATLAS_RETURN_IF_ERROR(add_volpack(task, participants));
      SPLATLAS_RETURN_IF_ERROR(compare(participants, task, Classification::kBefore, effort.views_compared));
      const std::string appearance_name = appearance.name;
      for (const Participant& participant : participants) {
        const RendererCost& cost = participant.cost;
        Row& row = table.rows.emplace_back(Row{{"scene", scene.name},
                                               {"transfer", appearance.name},
                                               {"renderer", cost.renderer},
                                               {"setting", cost.setting},
                                               {"mean", 255 * cost.error.mean},
                                               {"rmse", 255 * cost.error.rms}});
        if (is_quoted(cost) && appearance_name != "hard")
          raise(report.summary, "bias_max", 255 * std::abs(cost.error.mean));
        for (const AxisSwitch& across : kSwitches) {
          SPLATLAS_ASSIGN_OR_RETURN(const reference::PictureDifference d, pop_of(participant, task, across));
          row[across.axes] = 255 * d.rms;
          if (is_quoted(cost) && appearance_name != "thin")
            raise(report.summary, "pop_" + appearance_name, 255 * d.rms);
        }
      }
    }
  }
  report.tables.push_back(std::move(table));
  return {};
}

Result<void> measure_ripples(const Effort& effort, Report& report) {
  Table table{
      "ripple",
      "Ripple: the largest error of a plate of constant density against its closed form",
      {"in 1/255; faces_of_slices: rays enter and leave through faces that slices are parallel to, so that "
       "what is left is the sum of footprints",
       "side_faces: slices cut through the faces, whose slopes they sample (ripple_side_faces)"}};
  for (const CameraProjection projection : {CameraProjection::kParallel, CameraProjection::kPerspective}) {
    for (const NamedQuality& quality : kQualities) {
      SPLATLAS_ASSIGN_OR_RETURN(const Ripple ripple,
                                measure_ripple(quality.quality, projection, effort.ripple_views));
      table.rows.push_back(
          {{"projection", projection == CameraProjection::kParallel ? "parallel" : "perspective"},
           {"setting", quality.name},
           {"faces_of_slices", 255 * ripple.faces_of_slices},
           {"side_faces", 255 * ripple.side_faces}});
      if (quality.name != std::string(kQuoted)) continue;
      raise(report.summary, "ripple", 255 * ripple.faces_of_slices);
      raise(report.summary, "ripple_side_faces", 255 * ripple.side_faces);
    }
  }
  report.tables.push_back(std::move(table));
  return {};
}

constexpr std::array kThreadScenes{
    BenchScene{"volume", "Brain:volume(opacity=0.3)"}, BenchScene{"hard", "Head:volume(profile=hard)"},
    BenchScene{"hybrid",
               "\"Left hemisphere\":both(opacity=0.4) + \"Right hemisphere\":surface(opacity=0.4) + "
               "Cerebellum:surface"}};

/// Values whose bits differ between 1, 2 and 8 threads, at every quality, in both projections, with both
/// classifications.
Result<void> measure_threads(const std::shared_ptr<const Atlas>& atlas, Report& report) {
  Table table{"threads", "Values whose bits differ between 1, 2 and 8 threads, Colin 27"};
  std::uint64_t all = 0;
  for (const BenchScene& scene : kThreadScenes) {
    SPLATLAS_ASSIGN_OR_RETURN(const Selection selection, Selection::parse(scene.selection, atlas->graph()));
    std::vector<std::vector<float>> expected;  // of one thread
    std::uint64_t differ = 0;
    for (const unsigned threads : {1u, 2u, 8u}) {
      Renderer renderer(atlas, {.threads = threads});
      SPLATLAS_RETURN_IF_ERROR(renderer.select(selection));
      for (std::size_t n = 0; n < 4 * kQualities.size(); ++n) {
        Camera camera{.azimuth_deg = 31, .elevation_deg = 19};
        if (n % 2 == 1) camera.projection = CameraProjection::kPerspective;
        // No multiple of bands, vectors or packets
        RenderOptions options{.size = {253, 211}, .quality = kQualities[n / 4].quality};
        if (n / 2 % 2 == 1) options.classification = Classification::kAfter;
        SPLATLAS_ASSIGN_OR_RETURN(Frame frame, renderer.render(camera, options));
        if (threads == 1) {
          expected.push_back(std::move(frame.picture.rgba));
        } else {
          differ += bits_differ(frame.picture.rgba, expected[n]);
        }
      }
    }
    table.rows.push_back({{"scene", scene.name}, {"differ", differ}});
    all += differ;
  }
  report.summary["thread_bits_differ"] = all;
  if (all > 0) report.failures.push_back(fmt::format("{} values depend on the number of threads", all));
  report.tables.push_back(std::move(table));
  return {};
}

/// Pixels with a value that is not finite, over random scenes at every quality, in both projections,
/// classified before and after interpolation.
std::uint64_t nan_pixels_of(RandomScene scene) {
  std::uint64_t nan_pixels = 0;
  Renderer renderer(open_in_memory(scene.content), {.threads = 1});
  if (!renderer.select(scene.selection)) return 0;
  for (const NamedQuality& quality : kQualities) {
    for (const CameraProjection projection : {CameraProjection::kParallel, CameraProjection::kPerspective}) {
      for (const Classification classification : {Classification::kBefore, Classification::kAfter}) {
        scene.options.quality = quality.quality;
        scene.options.classification = classification;
        scene.camera.projection = projection;
        const Result<Frame> frame = renderer.render(scene.camera, scene.options);
        if (!frame) continue;  // refused, as views that are not finite must be
        const std::vector<float>& rgba = frame->picture.rgba;
        for (std::size_t n = 0; n < rgba.size(); n += 4) {
          if (!std::all_of(&rgba[n], &rgba[n] + 4, [](float value) { return std::isfinite(value); }))
            ++nan_pixels;
        }
      }
    }
  }
  return nan_pixels;
}

void measure_random_scenes(std::uint32_t count, Report& report) {
  std::uint64_t nan_pixels = 0;
  for (std::uint32_t n = 0; n < count; ++n)
    nan_pixels +=
        nan_pixels_of(random_scene(n)) + nan_pixels_of(whole_scene(1, n)) + nan_pixels_of(cut_scene(1, n));
  report.tables.push_back({"stress",
                           "Random scenes with extreme numbers, shapes and views, in every way to draw",
                           {"nan_pixels: pixels with a value that is not finite"},
                           {{{"scenes", 3 * count}, {"nan_pixels", nan_pixels}}}});
  report.summary["nan_pixels"] = nan_pixels;
  if (nan_pixels > 0) report.failures.push_back(fmt::format("{} pixels are not finite", nan_pixels));
}

Result<void> measure_orders(Report& report) {
  Table table{"order",
              "Orders of convergence on a smooth field: the slope of the error's logarithm, in theory 2",
              {"errors: RMS in 1/255, voxels of 1.5, 1 and 0.75 mm",
               "order_error_max: the largest deviation of an observed order from that of the method"}};
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<Convergence> rows, measure_convergence());
  for (const Convergence& row : rows) {
    table.rows.push_back({{"renderer", row.renderer}, {"order", row.order}});
    for (std::size_t n = 0; n < row.errors.size(); ++n)
      table.rows.back()[fmt::format("error_{}", n)] = 255 * row.errors[n];
    raise(report.summary, "order_error_max", std::abs(row.order - 2));
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
  SPLATLAS_RETURN_IF_ERROR(measure_threads(atlas, report));
  options.tell("random scenes");
  measure_random_scenes(effort.random_scenes, report);
  options.tell("orders of convergence");
  SPLATLAS_RETURN_IF_ERROR(measure_orders(report));
  return report;
}

}  // namespace splatlas

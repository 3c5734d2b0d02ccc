// Bench `hybrid`: surfaces mixed with volume in exact order, beside VTK.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "bench/atlases.h"
#include "bench/bench.h"
#include "bench/hybrid_scenes.h"
#include "bench/measure.h"
#include "bench/peers/x_server.h"
#include "format/color.h"
#include "format/system/result_macros.h"
#include "player/render_frame.h"
#include "player/view/shear.h"
#include "tests/reference/picture_difference.h"
#include "tests/reference/reference_picture.h"

namespace splatlas {
namespace {

constexpr double kStepMm = 1;  // VTK sample distance: its default, one voxel
constexpr int kTilePixels = 48;
constexpr int kRaysPerSide = 3;  // per pixel, for the reference of antialiasing

struct Setting {
  const char* name;
  Quality quality;
  bool antialiasing;  ///< off in VTK
};
constexpr std::array kSettings{
    Setting{"draft", Quality::kDraft, false}, Setting{"normal", Quality::kNormal, false},
    Setting{"normal, edges", Quality::kNormal, true}, Setting{"high", Quality::kHigh, false}};

/// One scene at one size.
struct HybridTask {
  std::shared_ptr<const Atlas> atlas;
  const AtlasContent& content;
  const HybridModel& model;
  const HybridScene& scene;
  int size = 512;
  int frames = 7;

  [[nodiscard]] RenderOptions options(const Setting& setting) const {
    RenderOptions options;
    options.size = {size, size};
    options.quality = setting.quality;
    options.antialiasing = setting.antialiasing;
    options.hybrid_shading = false;  // VTK does not shade either
    return options;
  }
};

/// Cost and error of a renderer.
struct HybridCost {
  std::string renderer, setting;
  unsigned threads = 2;
  Elapsed frame;
  Elapsed rasterize, sheets, resolve;  // ours
  double rmse = -1;                    // if compared
};

/// Draws once per principal axis in advance, so that no span build is timed.
Result<void> prepare(Renderer& renderer, const HybridTask& task) {
  SPLATLAS_RETURN_IF_ERROR(renderer.select(task.model.selection));
  std::set<Axis> prepared;
  for (int turn = 0; turn < task.frames; ++turn) {
    const RenderOptions options = task.options(kSettings[0]);
    SPLATLAS_ASSIGN_OR_RETURN(const ParallelView view,
                              parallel_view(hybrid_camera(turn), options.size, task.atlas->display()));
    if (!prepared.insert(factorise(view, task.atlas->grid()).principal).second) continue;
    SPLATLAS_RETURN_IF_ERROR(renderer.render(hybrid_camera(turn), options));
  }
  return {};
}

Contender ours(Renderer& renderer, const HybridTask& task, const Setting& setting) {
  return [&renderer, &task, &setting](int turn) -> Result<std::vector<Elapsed>> {
    Stopwatch watch;
    SPLATLAS_RETURN_IF_ERROR(renderer.render(hybrid_camera(turn), task.options(setting)));
    const Elapsed frame = watch.lap();
    const RenderStats& stats = renderer.stats();
    return std::vector{frame, stats.rasterize, stats.sheets, stats.resolve};
  };
}

VtkPeer vtk_peer(const HybridTask& task) {
  VtkPeer vtk(PictureSize{task.size, task.size});
  vtk.add_volume(task.model.volume, task.model.appearance, task.scene.mapper, kStepMm);
  for (const StructureIndex s : task.model.surfaces) {
    const StructureDraw& draw = task.model.selection.structures[s];
    const std::array<double, 3> color{srgb_to_linear(draw.color.r), srgb_to_linear(draw.color.g),
                                      srgb_to_linear(draw.color.b)};
    vtk.add_surface(task.content.surfaces[s], task.model.volume.grid, color, draw.opacity.value_or(1.0f));
  }
  if (task.scene.mapper == VtkVolumeMapper::kGpu) vtk.peel_depths();
  return vtk;
}

Result<ParallelView> view_of(int turn, const HybridTask& task) {
  return parallel_view(hybrid_camera(turn), {task.size, task.size}, task.atlas->display());
}

Result<std::vector<HybridCost>> take_times(const HybridTask& task) {
  std::array<Renderer, 2> renderers{Renderer(task.atlas, {.threads = 1}),
                                    Renderer(task.atlas, {.threads = 2})};
  std::vector<HybridCost> costs;
  std::vector<Contender> contenders;
  for (unsigned threads = 1; threads <= renderers.size(); ++threads) {
    Renderer& renderer = renderers[threads - 1];
    SPLATLAS_RETURN_IF_ERROR(prepare(renderer, task));
    for (const Setting& setting : kSettings) {
      costs.push_back({"splatlas", setting.name, threads, {}, {}, {}, {}});
      contenders.push_back(ours(renderer, task, setting));
    }
  }
  VtkPeer vtk = vtk_peer(task);
  SPLATLAS_ASSIGN_OR_RETURN(const ParallelView first_view, view_of(0, task));
  vtk.render(first_view);
  costs.push_back({task.scene.mapper == VtkVolumeMapper::kGpu ? "VTK peeling" : "VTK FixedPoint",
                   fmt::format("step {}", kStepMm),
                   2,
                   {},
                   {},
                   {},
                   {}});
  contenders.emplace_back([&](int turn) -> Result<std::vector<Elapsed>> {
    SPLATLAS_ASSIGN_OR_RETURN(const ParallelView view, view_of(turn, task));
    Stopwatch watch;
    vtk.render(view);
    return std::vector{watch.lap()};
  });
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<StageTimes> times,
                            measure_interleaved(contenders, task.frames));
  for (std::size_t n = 0; n < costs.size(); ++n) {
    costs[n].frame = median(times[n][0]);
    if (times[n].size() == 1) continue;
    costs[n].rasterize = median(times[n][1]);
    costs[n].sheets = median(times[n][2]);
    costs[n].resolve = median(times[n][3]);
  }
  return costs;
}

/// Camera of a tile of a picture, `kTilePixels` wide and high, with the pixel size of the picture.
Result<Camera> tile_camera(const HybridTask& task, double x, double y) {
  SPLATLAS_ASSIGN_OR_RETURN(const ParallelView view, view_of(0, task));
  Camera camera = hybrid_camera(0);
  camera.center_lps_mm = view.point_lps_mm(x * task.size, y * task.size);
  camera.zoom *= static_cast<double>(task.size) / kTilePixels;
  return camera;
}

/// RMS differences from fragment lists composited with the volume between them in double precision: over the
/// union of pixels and all channels, at every quality, in 1/255.
Result<std::array<double, kSettings.size()>> measure_errors(const HybridTask& task, int tiles_per_side) {
  Renderer renderer(task.atlas, {.threads = 2});
  SPLATLAS_RETURN_IF_ERROR(renderer.select(task.model.selection));
  std::array<double, kSettings.size()> squares{};
  std::array<std::size_t, kSettings.size()> pixels{};
  for (int tile = 0; tile < tiles_per_side * tiles_per_side; ++tile) {
    const auto at = [&](int n) { return 0.25 + 0.5 * (n + 0.5) / tiles_per_side; };
    SPLATLAS_ASSIGN_OR_RETURN(const Camera camera,
                              tile_camera(task, at(tile % tiles_per_side), at(tile / tiles_per_side)));
    RenderOptions options;
    options.size = {kTilePixels, kTilePixels};
    options.hybrid_shading = false;
    const reference::ReferenceScene scene{task.content, task.model.selection, camera, options};
    const std::array truths{reference::render_truth(scene),
                            reference::render_mean_truth(scene, kRaysPerSide)};
    for (std::size_t n = 0; n < kSettings.size(); ++n) {
      options = task.options(kSettings[n]);
      options.size = {kTilePixels, kTilePixels};
      SPLATLAS_ASSIGN_OR_RETURN(const Picture picture, renderer.render(camera, options));
      const reference::PictureDifference d =
          reference::difference(picture, truths[kSettings[n].antialiasing ? 1 : 0]);
      squares[n] += d.rms * d.rms * static_cast<double>(d.pixels);
      pixels[n] += d.pixels;
    }
  }
  for (std::size_t n = 0; n < kSettings.size(); ++n) {
    squares[n] = 255 * std::sqrt(squares[n] / static_cast<double>(std::max<std::size_t>(pixels[n], 1)));
  }
  return squares;
}

void add_rows(const HybridTask& task, const std::vector<HybridCost>& costs, Table& table) {
  const HybridCost& unit = costs.back();
  for (const HybridCost& cost : costs) {
    table.rows.push_back({{"scene", task.scene.name},
                          {"size", task.size},
                          {"renderer", cost.renderer},
                          {"setting", cost.setting},
                          {"threads", cost.threads},
                          {"triangles", task.model.triangles},
                          {"wall_ms", cost.frame.wall_ms},
                          {"cpu_ms", cost.frame.cpu_ms},
                          {"wall_ratio", cost.frame.wall_ms / unit.frame.wall_ms},
                          {"cpu_ratio", cost.frame.cpu_ms / unit.frame.cpu_ms}});
    if (cost.sheets.wall_ms == 0) continue;
    table.rows.back().update({{"raster_cpu", cost.rasterize.cpu_ms},
                              {"sheets_cpu", cost.sheets.cpu_ms},
                              {"resolve_cpu", cost.resolve.cpu_ms}});
    if (cost.rmse >= 0) table.rows.back().update({{"rmse", cost.rmse}});
  }
}

/// Wall clock of normal quality with two threads, against VTK.
void summarise(const HybridTask& task, const std::vector<HybridCost>& costs,
               nlohmann::ordered_json& summary) {
  const bool peeled = task.scene.mapper == VtkVolumeMapper::kGpu;
  const std::string key = peeled ? fmt::format("peeled_{}", task.size) : "opaque_max";
  for (const HybridCost& cost : costs) {
    const double ratio = cost.frame.wall_ms / costs.back().frame.wall_ms;
    if (cost.threads != 2) continue;
    if (cost.setting == "normal") {
      raise(summary, key, ratio);
      if (cost.rmse >= 0) raise(summary, "rmse_max", cost.rmse);
    }
    if (cost.setting == "normal, edges") raise(summary, "antialiased_" + key, ratio);
  }
}

}  // namespace

Result<Report> run_hybrid_bench(const BenchOptions& options) {
  Report report;
  SPLATLAS_ASSIGN_OR_RETURN(const XServer display, start_x_server());
  SPLATLAS_ASSIGN_OR_RETURN(const std::shared_ptr<const Atlas> atlas, open_colin27(options));
  SPLATLAS_ASSIGN_OR_RETURN(const AtlasContent content, atlas->read_all());
  Table table{
      "hybrid",
      "Surfaces mixed with volume, in exact order",
      {"wall_ratio, cpu_ratio: against VTK, with depth peeling for translucent surfaces",
       "rmse: of tiles of 48x48 pixels against the fragments on the ray of every pixel's centre and the "
       "volume between them in double precision, in 1/255 of linear light; edges: against the mean of 9 "
       "rays a pixel"},
      {}};
  for (const HybridScene& scene : hybrid_scenes()) {
    SPLATLAS_ASSIGN_OR_RETURN(const HybridModel model, hybrid_model(content, scene));
    for (const int size : {512, 1024}) {
      options.tell(fmt::format("{}, {}x{}", scene.name, size, size));
      const HybridTask task{atlas, content, model, scene, size, options.quick ? 3 : 7};
      SPLATLAS_ASSIGN_OR_RETURN(std::vector<HybridCost> costs, take_times(task));
      if (size == 512) {
        SPLATLAS_ASSIGN_OR_RETURN(const auto errors, measure_errors(task, options.quick ? 1 : 2));
        for (HybridCost& cost : costs) {
          for (std::size_t n = 0; n < kSettings.size(); ++n) {
            if (cost.setting == kSettings[n].name) cost.rmse = errors[n];
          }
        }
      }
      add_rows(task, costs, table);
      summarise(task, costs, report.summary);
    }
  }
  report.tables.push_back(std::move(table));
  return report;
}

}  // namespace splatlas

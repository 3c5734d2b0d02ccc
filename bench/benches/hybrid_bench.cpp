// Bench `hybrid`: surfaces mixed with volume in exact order, beside VTK.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "bench/bench.h"
#include "bench/scenes/atlases.h"
#include "bench/scenes/participants.h"
#include "format/content/color.h"
#include "format/result_macros.h"
#include "tests/reference/reference_picture.h"

namespace splatlas {
namespace {

constexpr double kStepMm = 1;  // VTK sample distance: its default, one voxel
constexpr int kTilePixels = 48;

/// VTK does not antialias.
constexpr std::array kSettings{NamedQuality{"draft", Quality::kDraft, false},
                               NamedQuality{"normal", Quality::kNormal, false},
                               NamedQuality{"high", Quality::kHigh, false}};

/// Parts of the Colin 27 head, and the VTK renderer to compare.
struct HybridScene {
  const char* name;
  const char* selection;   ///< all volumes have one appearance
  VtkVolumeMapper mapper;  ///< kGpu: translucent surfaces, with depth peeling

  [[nodiscard]] bool peeled() const { return mapper == VtkVolumeMapper::kGpu; }
};
constexpr std::array kScenes{
    HybridScene{"translucent half",
                "\"Left hemisphere\":volume(opacity=0.3,color=#ffffff) + "
                "\"Right hemisphere\":surface(opacity=0.4)",
                VtkVolumeMapper::kGpu},
    HybridScene{"translucent brain",
                "\"Left hemisphere\":both(opacity=0.4,color=#ffffff) + "
                "\"Right hemisphere\":both(opacity=0.4,color=#ffffff)",
                VtkVolumeMapper::kGpu},
    HybridScene{"opaque half",
                "\"Left hemisphere\":volume(opacity=0.3,color=#ffffff) + \"Right hemisphere\":surface",
                VtkVolumeMapper::kFixedPoint}};

/// One scene at one size.
struct HybridTask : ErrorTask {
  const AtlasContent& content;
  const HybridScene& scene;

  [[nodiscard]] std::vector<StructureIndex> surfaces() const {
    return atlas->tree().plan(model.selection).surfaces;
  }
};

/// VTK in parallel projection, with surfaces. Draws once in advance.
Result<void> add_vtk_with_surfaces(const HybridTask& task, std::vector<Participant>& participants) {
  VtkPeer vtk(task.size);
  vtk.add_volume(task.model.volume, task.model.appearance, task.scene.mapper, kStepMm);
  for (const StructureIndex s : task.surfaces()) {
    const StructureDraw& draw = task.model.selection.structures[s];
    const std::array<double, 3> color{srgb_to_linear(draw.color.r), srgb_to_linear(draw.color.g),
                                      srgb_to_linear(draw.color.b)};
    vtk.add_surface(task.content.surfaces[s], task.model.volume.grid, color, draw.opacity.value_or(1.0f));
  }
  vtk.shade_volumes(true);
  if (task.scene.peeled()) vtk.peel_depths();
  Participant& participant = participants.emplace_back();
  participant.cost = {task.scene.peeled() ? "VTK peeling" : "VTK FixedPoint", fmt::format("step {}", kStepMm),
                      2};
  participant.draw = [vtk, &task](const Camera& camera) mutable -> Result<void> {
    SPLATLAS_ASSIGN_OR_RETURN(const ParallelView view, task.view(camera));
    vtk.render(view);
    return {};
  };
  return participant.draw(task.camera(0));
}

Result<std::vector<RendererCost>> measure(const HybridTask& task) {
  std::vector<Participant> participants;
  for (const unsigned threads : {1u, 2u})
    SPLATLAS_RETURN_IF_ERROR(add_ours(task, Classification::kBefore, threads, participants, kSettings));
  SPLATLAS_RETURN_IF_ERROR(add_vtk_with_surfaces(task, participants));
  return take_times(std::move(participants), task);
}

/// Camera of a tile of a picture, `kTilePixels` wide and high, with the pixel size of the picture.
Result<Camera> tile_camera(const HybridTask& task, double x, double y) {
  SPLATLAS_ASSIGN_OR_RETURN(const ParallelView view, task.view(task.camera(0)));
  Camera camera = task.camera(0);
  camera.center_lps_mm = view.point_lps_mm(x * task.size.width, y * task.size.height);
  camera.zoom *= static_cast<double>(task.size.width) / kTilePixels;
  return camera;
}

/// RMS differences from fragment lists composited with the volume between them in double precision: over the
/// union of pixels and all channels, at every quality, in 1/255.
Result<std::vector<double>> measure_errors(const HybridTask& task, int tiles_per_side) {
  Renderer renderer(task.atlas, {.threads = 2});
  SPLATLAS_RETURN_IF_ERROR(renderer.select(task.model.selection));
  std::vector<double> squares(kSettings.size());
  std::array<std::size_t, kSettings.size()> pixels{};
  for (int tile = 0; tile < tiles_per_side * tiles_per_side; ++tile) {
    const auto at = [&](int n) { return 0.25 + 0.5 * (n + 0.5) / tiles_per_side; };
    SPLATLAS_ASSIGN_OR_RETURN(const Camera camera,
                              tile_camera(task, at(tile % tiles_per_side), at(tile / tiles_per_side)));
    RenderOptions options{.size = {kTilePixels, kTilePixels}, .antialiasing = false};
    const reference::ReferencePicture truth =
        reference::render_truth({task.content, task.model.selection, camera, options});
    for (std::size_t n = 0; n < kSettings.size(); ++n) {
      options.quality = kSettings[n].quality;
      SPLATLAS_ASSIGN_OR_RETURN(const Frame frame, renderer.render(camera, options));
      const reference::PictureDifference d = reference::difference(frame.picture, truth);
      squares[n] += d.rms * d.rms * static_cast<double>(d.pixels);
      pixels[n] += d.pixels;
    }
  }
  for (std::size_t n = 0; n < kSettings.size(); ++n) {
    squares[n] = 255 * std::sqrt(squares[n] / static_cast<double>(std::max<std::size_t>(pixels[n], 1)));
  }
  return squares;
}

/// `errors` of each setting, if compared. The last cost is that of VTK.
void add_rows(const HybridTask& task, const std::vector<RendererCost>& costs, std::span<const double> errors,
              Table& table, nlohmann::ordered_json& summary) {
  const RendererCost& unit = costs.back();
  const std::string key = task.scene.peeled() ? fmt::format("peeled_{}", task.size.width) : "opaque_max";
  for (std::size_t n = 0; n < costs.size(); ++n) {
    const RendererCost& cost = costs[n];
    const double ratio = cost.frame.wall_ms / unit.frame.wall_ms;
    Row& row = table.rows.emplace_back(Row{{"scene", task.scene.name},
                                           {"size", task.size.width},
                                           {"renderer", cost.renderer},
                                           {"setting", cost.setting},
                                           {"threads", cost.threads},
                                           {"wall_ms", cost.frame.wall_ms},
                                           {"cpu_ms", cost.frame.cpu_ms},
                                           {"wall_ratio", ratio}});
    if (&cost == &unit) continue;
    if (!errors.empty()) row["rmse"] = errors[n % kSettings.size()];

    if (cost.threads != 2 || cost.setting != "normal") continue;
    raise(summary, key, ratio);
    if (!errors.empty()) raise(summary, "rmse_max", row["rmse"].get<double>());
  }
}

}  // namespace

Result<Report> run_hybrid_bench(const BenchOptions& options) {
  Report report;
  SPLATLAS_ASSIGN_OR_RETURN(const XServer display, start_x_server());
  SPLATLAS_ASSIGN_OR_RETURN(const std::shared_ptr<const Atlas> atlas, open_colin27(options));
  SPLATLAS_ASSIGN_OR_RETURN(const AtlasContent content, atlas->read_all());
  Table table{"hybrid",
              "Surfaces mixed with volume, in exact order",
              {"wall_ratio: against VTK, with depth peeling for translucent surfaces",
               "rmse: of tiles of 48x48 pixels against double precision, in 1/255 of linear light"}};
  for (const HybridScene& scene : kScenes) {
    SPLATLAS_ASSIGN_OR_RETURN(const ErrorModel model, error_model(content, scene.selection));
    for (const int size : {512, 1024}) {
      options.tell(fmt::format("{}, {}x{}", scene.name, size, size));
      const HybridTask task{{atlas, model, {size, size}, options.quick ? 3 : 7}, content, scene};
      SPLATLAS_ASSIGN_OR_RETURN(const std::vector<RendererCost> costs, measure(task));
      std::vector<double> errors;
      if (size == 512) {
        SPLATLAS_ASSIGN_OR_RETURN(errors, measure_errors(task, options.quick ? 1 : 2));
      }
      add_rows(task, costs, errors, table, report.summary);
    }
  }
  report.tables.push_back(std::move(table));
  return report;
}

}  // namespace splatlas

#include "bench/benches/clinic_tables.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "bench/measure/frames.h"
#include "bench/measure/measure.h"
#include "bench/measure/peak_memory.h"
#include "bench/peers/vtk_peer.h"
#include "bench/peers/x_server.h"
#include "bench/scenes/error_scenes.h"
#include "bench/scenes/head_ct.h"
#include "format/result_macros.h"
#include "player/renderer.h"
#include "tests/support/temporary_folder.h"

namespace splatlas {
namespace {

constexpr double kBudgetMs = 33;  // of the window
constexpr int kDrafts = 11, kFirstDrafts = 4;

constexpr std::array kClinicScenes{
    BenchScene{"volume", "Bone:volume + \"Soft tissue\":volume"},
    BenchScene{"surfaces", "Bone:surface + \"Soft tissue\":surface"},
    BenchScene{"mixed", "Bone:surface + \"Soft tissue\":volume(opacity=0.05)"}};

/// Frames of a selection, as the window draws them: a draft, a normal picture, and drafts of a turn.
struct PlayedDrafts {
  Elapsed first, refined, steady;  // from the opening of the file, the same, median
  int first_level = 0;
  RenderStats stats;  // of the last frame
};

Result<PlayedDrafts> play(const std::filesystem::path& path, const char* text, const Camera& camera,
                          const RenderOptions& options) {
  PlayedDrafts played;
  Stopwatch watch;
  SPLATLAS_ASSIGN_OR_RETURN(const std::shared_ptr<const Atlas> atlas, Atlas::open(path));
  Renderer renderer(atlas);
  SPLATLAS_ASSIGN_OR_RETURN(const Selection selection, Selection::parse(text, atlas->graph()));
  SPLATLAS_RETURN_IF_ERROR(renderer.select(selection));
  Frame frame;
  SPLATLAS_RETURN_IF_ERROR(renderer.render(camera, options, frame));
  played.first = played.refined = watch.lap();
  played.first_level = frame.stats.level;
  RenderOptions normal = options;
  normal.quality = Quality::kNormal;
  SPLATLAS_RETURN_IF_ERROR(renderer.render(camera, normal, frame));
  played.refined += watch.lap();
  std::vector<Elapsed> times;
  for (int n = -kFirstDrafts; n < kDrafts; ++n) {
    Camera turned = camera;
    turned.azimuth_deg += n;
    watch.lap();
    SPLATLAS_RETURN_IF_ERROR(renderer.render(turned, options, frame));
    if (n >= 0) times.push_back(watch.lap());
  }
  played.steady = median(times);
  played.stats = frame.stats;
  return played;
}

/// The content with grey values of 8 bits, black to white over the display's window: VTK's copy has 8.
Result<AtlasContent> read_with_8_bits(const std::filesystem::path& path) {
  SPLATLAS_ASSIGN_OR_RETURN(const std::shared_ptr<const Atlas> atlas, Atlas::open(path));
  SPLATLAS_ASSIGN_OR_RETURN(AtlasContent content, atlas->read_all());
  const std::size_t voxels = content.values.bytes.size() / sizeof(std::int16_t);
  VoxelBuffer greys{VoxelType::kUInt8, std::vector<std::byte>(voxels)};
  const double low = content.display.window_low, width = content.display.window_high - low;
  std::transform(
      content.values.as<std::int16_t>(), content.values.as<std::int16_t>() + voxels, greys.bytes.begin(),
      [&](std::int16_t value) {
        return static_cast<std::byte>(std::lround(255 * std::clamp((value - low) / width, 0.0, 1.0)));
      });
  content.values = std::move(greys);
  content.display.window_low = 0;
  content.display.window_high = 255;
  return content;
}

/// Median time of a frame of 1920x1080 by VTK: a ray caster on the CPU with VTK's sample distance of 1 mm,
/// and surfaces on the display's OpenGL.
Result<double> vtk_frame_ms(const AtlasContent& content, const BenchScene& scene) {
  const PictureSize size{1920, 1080};
  VtkPeer vtk(size);
  SPLATLAS_ASSIGN_OR_RETURN(const Selection selection, Selection::parse(scene.selection, content.graph));
  const auto is_volume = [](const StructureDraw& draw) { return draw.mode == DrawMode::kVolume; };
  if (std::ranges::any_of(selection.structures, is_volume)) {
    SPLATLAS_ASSIGN_OR_RETURN(const ErrorModel model, error_model(content, scene.selection));
    vtk.add_volume(model.volume, model.appearance, VtkVolumeMapper::kFixedPoint, 1);
    vtk.shade_volumes(true);
  }
  for (StructureIndex s = 0; s < selection.structures.size(); ++s) {
    if (selection.structures[s].mode == DrawMode::kSurface)
      vtk.add_surface(content.surfaces[s], storage_grid(content), {0.8, 0.8, 0.8}, 1);
  }
  std::vector<double> times;
  for (int n = -1; n < 5; ++n) {
    Camera camera = oblique_camera();
    camera.azimuth_deg += n;
    SPLATLAS_ASSIGN_OR_RETURN(const ParallelView view, parallel_view(camera, size, content.display));
    Stopwatch watch;
    vtk.render(view);
    if (n >= 0) times.push_back(watch.lap().wall_ms);
  }
  return median(times);
}

Result<void> add_drafts(const std::filesystem::path& path, std::int64_t voxels, const BenchOptions& options,
                        Report& report) {
  Table table{"clinic",
              "A head CT of 512 x 512 x 324 voxels: drafts of all threads",
              {"budget_ms: 33 is the window's; 0: exact drafts",
               "first, refined: from opening the file to the first draft, and to the normal picture after it",
               "first_level, level: means of 2^level voxels along each axis; draft: of a turn after the "
               "normal picture",
               "surface_level: surfaces of blocks of 2^surface_level voxels",
               "bytes_per_voxel: peak memory of the renderer, per voxel of the grid",
               "vtk_ms: a frame by VTK, volumes on the CPU, surfaces on Mesa's OpenGL"}};
  double first = 0, bytes = 0, over_vtk = 0;
  std::array<double, kClinicScenes.size()> vtk_ms{};
  if (!options.quick) {
    SPLATLAS_ASSIGN_OR_RETURN(const XServer display, start_x_server());
    SPLATLAS_ASSIGN_OR_RETURN(const AtlasContent content, read_with_8_bits(path));
    for (std::size_t n = 0; n < vtk_ms.size(); ++n) {
      options.tell(fmt::format("{} by VTK", kClinicScenes[n].name));
      SPLATLAS_ASSIGN_OR_RETURN(vtk_ms[n], vtk_frame_ms(content, kClinicScenes[n]));
    }
  }
  for (std::size_t n = 0; n < kClinicScenes.size(); ++n) {
    const BenchScene& scene = kClinicScenes[n];
    for (const PictureSize size : {PictureSize{512, 512}, PictureSize{1920, 1080}}) {
      for (const double budget : {kBudgetMs, 0.0}) {
        if (options.quick && (budget == 0 || size.width == 512)) continue;
        options.tell(fmt::format("{}, {}x{}, budget {} ms", scene.name, size.width, size.height, budget));
        SPLATLAS_ASSIGN_OR_RETURN(const PeakMemory memory, PeakMemory::start());
        SPLATLAS_ASSIGN_OR_RETURN(
            const PlayedDrafts played,
            play(path, scene.selection, oblique_camera(),
                 {.size = size, .quality = Quality::kDraft, .draft_budget_ms = budget}));
        SPLATLAS_ASSIGN_OR_RETURN(const std::uint64_t grown, memory.grown_bytes());
        const double per_voxel = static_cast<double>(grown) / static_cast<double>(voxels);
        table.rows.push_back({{"scene", scene.name},
                              {"size", fmt::format("{}x{}", size.width, size.height)},
                              {"budget_ms", budget},
                              {"first_ms", played.first.wall_ms},
                              {"first_cpu_ms", played.first.cpu_ms},
                              {"first_level", played.first_level},
                              {"refined_ms", played.refined.wall_ms},
                              {"draft_ms", played.steady.wall_ms},
                              {"draft_cpu_ms", played.steady.cpu_ms},
                              {"level", played.stats.level},
                              {"surface_level", played.stats.surface_level},
                              {"bytes_per_voxel", per_voxel}});
        if (size.width == 512) continue;
        if (!options.quick) table.rows.back()["vtk_ms"] = vtk_ms[n];
        if (budget == 0) continue;
        if (!options.quick) over_vtk = std::max(over_vtk, played.steady.wall_ms / vtk_ms[n]);
        report.summary[fmt::format("clinic_draft_{}_ms", scene.name)] = played.steady.wall_ms;
        first = std::max(first, played.first.wall_ms);
        bytes = std::max(bytes, per_voxel);
      }
    }
  }
  report.summary["clinic_first_ms"] = first;
  report.summary["clinic_bytes_per_voxel"] = bytes;
  if (!options.quick) report.summary["clinic_draft_over_vtk"] = over_vtk;
  report.tables.push_back(std::move(table));
  return {};
}

Result<void> add_growth(const std::filesystem::path& small, const std::filesystem::path& large,
                        const BenchOptions& options, Report& report) {
  Table table{"growth",
              "One picture of 512x512, 8 times the voxels: steady drafts at the window's budget, all threads",
              {"growth: CPU time over that of the CT as it is"}};
  Camera perspective = oblique_camera();
  perspective.projection = CameraProjection::kPerspective;
  double largest = 0;
  for (const auto& [name, text, camera] : {std::tuple("sheets", kClinicScenes[0].selection, oblique_camera()),
                                           {"rays", kClinicScenes[0].selection, perspective},
                                           {"surfaces", kClinicScenes[1].selection, oblique_camera()}}) {
    options.tell(fmt::format("growth of {}", name));
    const RenderOptions draft{.quality = Quality::kDraft, .draft_budget_ms = kBudgetMs};
    SPLATLAS_ASSIGN_OR_RETURN(const PlayedDrafts unit, play(small, text, camera, draft));
    SPLATLAS_ASSIGN_OR_RETURN(const PlayedDrafts grown, play(large, text, camera, draft));
    const double growth = grown.steady.cpu_ms / unit.steady.cpu_ms;
    table.rows.push_back({{"renderer", name},
                          {"cpu_ms", unit.steady.cpu_ms},
                          {"cpu_ms_8", grown.steady.cpu_ms},
                          {"level_8", grown.stats.level},
                          {"growth", growth}});
    largest = std::max(largest, growth);
  }
  report.summary["all_growth_picture"] = largest;
  report.tables.push_back(std::move(table));
  return {};
}

}  // namespace

Result<void> add_clinic(const BenchOptions& options, Report& report) {
  if (std::error_code error; !std::filesystem::exists(head_ct_file(), error)) {
    options.tell(fmt::format("{} is missing: no clinic table; install Debian's package invesalius-examples",
                             head_ct_file().string()));
    return {};
  }
  const TemporaryFolder folder;
  SPLATLAS_ASSIGN_OR_RETURN(const PeakMemory memory, PeakMemory::start());
  SPLATLAS_ASSIGN_OR_RETURN(const BuildReport built, build_head_ct({2, 2, 3}, folder.path(), options));
  SPLATLAS_ASSIGN_OR_RETURN(const std::uint64_t peak, memory.grown_bytes());
  constexpr std::int64_t kVoxels = std::int64_t{512} * 512 * 324;
  report.summary["clinic_build_seconds"] =
      std::accumulate(built.stages.begin(), built.stages.end(), 0.0,
                      [](double sum, const auto& s) { return sum + s.seconds; });
  report.summary["clinic_build_bytes_per_voxel"] = static_cast<double>(peak) / static_cast<double>(kVoxels);
  SPLATLAS_RETURN_IF_ERROR(add_drafts(folder.path() / "2x2x3.atlas", kVoxels, options, report));
  if (options.quick) return {};
  SPLATLAS_RETURN_IF_ERROR(build_head_ct({1, 1, 1}, folder.path(), options));
  SPLATLAS_RETURN_IF_ERROR(build_head_ct({2, 2, 2}, folder.path(), options));
  return add_growth(folder.path() / "1x1x1.atlas", folder.path() / "2x2x2.atlas", options, report);
}

}  // namespace splatlas

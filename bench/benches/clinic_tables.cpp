// A CT as large as a clinic's, for the bench `scale`.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <zlib.h>

#include "bench/bench.h"
#include "bench/measure/frames.h"
#include "bench/measure/measure.h"
#include "bench/peers/vtk_peer.h"
#include "bench/scenes/atlases.h"
#include "bench/scenes/error_scenes.h"
#include "format/result_macros.h"
#include "player/renderer.h"
#include "tests/support/temporary_folder.h"

namespace splatlas {
namespace {

constexpr const char* kCtFile = "/usr/share/doc/invesalius-examples/examples/Cranium.inv3";
// Of the file's main.plist.
constexpr std::array<int, 3> kCtSize{256, 256, 108};
constexpr std::array<double, 3> kCtSpacingMm{0.957031, 0.957031, 1.5};
constexpr std::size_t kCtVoxels = std::size_t{256} * 256 * 108;

/// The 16-bit voxels of the CT: member matrix.dat of a tar archive, compressed by gzip.
Result<std::vector<std::int16_t>> read_voxels() {
  const std::string path = kCtFile;
  const std::unique_ptr<gzFile_s, int (*)(gzFile)> file(gzopen(path.c_str(), "rb"), gzclose);
  constexpr std::size_t kRecord = 512, kNameBytes = 100, kCtSizeAt = 124;
  std::array<char, kRecord> header{};
  while (gzfread(header.data(), kRecord, 1, file.get()) == 1) {
    const std::string_view name(header.data(), strnlen(header.data(), kNameBytes));
    const auto bytes = static_cast<std::size_t>(std::strtoull(&header[kCtSizeAt], nullptr, 8));
    if (name.ends_with("matrix.dat") && bytes == kCtVoxels * sizeof(std::int16_t)) {
      std::vector<std::int16_t> voxels(kCtVoxels);
      if (gzfread(voxels.data(), bytes, 1, file.get()) == 1) return voxels;
      break;
    }
    const std::size_t records = (bytes + kRecord - 1) / kRecord;
    if (gzseek(file.get(), static_cast<z_off_t>(records * kRecord), SEEK_CUR) < 0) break;
  }
  return fail(ErrorCode::kFailed, fmt::format("{}: has no matrix.dat of 256 x 256 x 108 voxels", path));
}

/// Neighbours of a finer voxel along one axis, clamped at the ends.
struct Between {
  std::size_t before = 0, behind = 0;
  float share = 0;  ///< of the voxel behind

  Between(int finer, int times, int size) {
    const double at = std::clamp((finer + 0.5) / times - 0.5, 0.0, size - 1.0);
    before = static_cast<std::size_t>(at);
    behind = std::min(before + 1, static_cast<std::size_t>(size - 1));
    share = static_cast<float>(at - static_cast<double>(before));
  }
  [[nodiscard]] float mix(float a, float b) const { return a + share * (b - a); }
};

/// Writes the finer volume as NRRD.
void write_finer(const std::vector<std::int16_t>& voxels, const std::array<int, 3>& times,
                 const std::filesystem::path& path) {
  std::ofstream file(path, std::ios::binary);
  file << fmt::format(
      "NRRD0004\ntype: int16\ndimension: 3\nspace: left-posterior-superior\nsizes: {} {} {}\n"
      "space directions: ({},0,0) (0,{},0) (0,0,{})\nspace origin: (0,0,0)\nendian: little\nencoding: "
      "raw\n\n",
      kCtSize[0] * times[0], kCtSize[1] * times[1], kCtSize[2] * times[2], kCtSpacingMm[0] / times[0],
      kCtSpacingMm[1] / times[1], kCtSpacingMm[2] / times[2]);
  const auto row_of = [&](std::size_t j, std::size_t k) { return &voxels[(k * 256 + j) * 256]; };
  std::vector<std::int16_t> row(static_cast<std::size_t>(kCtSize[0] * times[0]));
  for (int k = 0; k < kCtSize[2] * times[2]; ++k) {
    const Between slices(k, times[2], kCtSize[2]);
    for (int j = 0; j < kCtSize[1] * times[1]; ++j) {
      const Between rows(j, times[1], kCtSize[1]);
      const std::array<const std::int16_t*, 4> around{
          row_of(rows.before, slices.before), row_of(rows.behind, slices.before),
          row_of(rows.before, slices.behind), row_of(rows.behind, slices.behind)};
      for (int i = 0; i < kCtSize[0] * times[0]; ++i) {
        const Between columns(i, times[0], kCtSize[0]);
        const auto along = [&](const std::int16_t* of) {
          return columns.mix(of[columns.before], of[columns.behind]);
        };
        const float value = slices.mix(rows.mix(along(around[0]), along(around[1])),
                                       rows.mix(along(around[2]), along(around[3])));
        row[static_cast<std::size_t>(i)] = static_cast<std::int16_t>(std::lround(value));
      }
      file.write(reinterpret_cast<const char*>(row.data()),
                 static_cast<std::streamsize>(row.size() * sizeof(std::int16_t)));
    }
  }
}

/// The CT interpolated linearly to `times` the voxels along each axis: an atlas of "Bone" and "Soft tissue"
/// by thresholds, as TIMESxTIMESxTIMES.atlas. kFailed if the CT has another size.
Result<BuildReport> build_head_ct(const std::array<int, 3>& times, const std::filesystem::path& folder,
                                  const BenchOptions& options) {
  const std::string name = fmt::format("{}x{}x{}", times[0], times[1], times[2]);
  options.tell(fmt::format("building the atlas of the CT, finer {}", name));
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<std::int16_t> voxels, read_voxels());
  SourceFiles sources;
  sources.volume = folder / (name + ".nrrd");
  write_finer(voxels, times, sources.volume);
  for (const char* const rule : {"Bone=threshold:226", "Soft tissue=threshold:-200:226"}) {
    SPLATLAS_ASSIGN_OR_RETURN(SegmentRule segment, parse_segment(rule));
    sources.segments.push_back(std::move(segment));
  }
  return build_file(sources, folder / (name + ".atlas"));
}

constexpr double kBudgetMs = 33;  // of the window
constexpr PictureSize kSize{1920, 1080};
constexpr double kVoxels = 512.0 * 512 * 324;
constexpr int kDrafts = 11, kFirstDrafts = 4;

constexpr std::array kClinicScenes{
    BenchScene{"volume", "Bone:volume + \"Soft tissue\":volume"},
    BenchScene{"surfaces", "Bone:surface + \"Soft tissue\":surface"},
    BenchScene{"mixed", "Bone:surface + \"Soft tissue\":volume(opacity=0.05)"},
    BenchScene{"cut", "Bone:surface + \"Soft tissue\":volume(opacity=0.05)", "left=122"}};

/// Frames of a selection, as the window draws them: a draft, a normal picture, and drafts of a turn.
struct PlayedDrafts {
  Elapsed first, refined, steady;  // from the opening of the file, the same, median
  RenderStats stats;               // of the last frame
};

Result<PlayedDrafts> play(const std::filesystem::path& path, const char* text, Camera camera,
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
  RenderOptions normal = options;
  normal.quality = Quality::kNormal;
  SPLATLAS_RETURN_IF_ERROR(renderer.render(camera, normal, frame));
  played.refined += watch.lap();
  std::vector<Elapsed> times;
  camera.azimuth_deg -= kFirstDrafts;
  for (int n = -kFirstDrafts; n < kDrafts; ++n, camera.azimuth_deg += 1) {
    watch.lap();
    SPLATLAS_RETURN_IF_ERROR(renderer.render(camera, options, frame));
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
  VtkPeer vtk(kSize);
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
    SPLATLAS_ASSIGN_OR_RETURN(const ParallelView view, parallel_view(camera, kSize, content.display));
    Stopwatch watch;
    vtk.render(view);
    if (n >= 0) times.push_back(watch.lap().wall_ms);
  }
  return median(times);
}

Result<void> add_drafts(const std::filesystem::path& path, const BenchOptions& options, Report& report) {
  Table table{
      "clinic",
      "A head CT of 512 x 512 x 324 voxels: drafts of 1920x1080, all threads",
      {"budget_ms: 33 is the window's; 0: exact drafts",
       "first, refined: from opening the file to the first draft, and to the normal picture after it",
       "level: means of 2^level voxels along each axis; draft: of a turn after the normal picture",
       "bytes_per_voxel: peak memory of the renderer, per voxel of the grid",
       "vtk_ms: a frame by VTK, volumes on the CPU, surfaces on Mesa's OpenGL; cut: of the whole head"}};
  SPLATLAS_ASSIGN_OR_RETURN(const XServer display, start_x_server());
  SPLATLAS_ASSIGN_OR_RETURN(const AtlasContent content, read_with_8_bits(path));
  for (const BenchScene& scene : kClinicScenes) {
    options.tell(fmt::format("{} by VTK", scene.name));
    RenderOptions draft{.size = kSize, .quality = Quality::kDraft};
    SPLATLAS_ASSIGN_OR_RETURN(draft.cuts, parse_cuts(scene.cuts));
    SPLATLAS_ASSIGN_OR_RETURN(const double vtk_ms, vtk_frame_ms(content, scene));
    for (const double budget : {kBudgetMs, 0.0}) {
      if (options.quick && budget == 0) continue;
      options.tell(fmt::format("{}, budget {} ms", scene.name, budget));
      SPLATLAS_ASSIGN_OR_RETURN(const PeakMemory memory, PeakMemory::start());
      draft.draft_budget_ms = budget;
      SPLATLAS_ASSIGN_OR_RETURN(const PlayedDrafts played,
                                play(path, scene.selection, oblique_camera(), draft));
      SPLATLAS_ASSIGN_OR_RETURN(const std::uint64_t grown, memory.grown_bytes());
      const double per_voxel = static_cast<double>(grown) / kVoxels;
      table.rows.push_back({{"scene", scene.name},
                            {"budget_ms", budget},
                            {"first_ms", played.first.wall_ms},
                            {"refined_ms", played.refined.wall_ms},
                            {"draft_ms", played.steady.wall_ms},
                            {"level", played.stats.level},
                            {"surface_level", played.stats.surface_level},
                            {"bytes_per_voxel", per_voxel},
                            {"vtk_ms", vtk_ms}});
      if (budget == 0) continue;
      report.summary[fmt::format("clinic_draft_{}_ms", scene.name)] = played.steady.wall_ms;
      if (!draft.cuts.empty()) continue;  // of half the head
      raise(report.summary, "clinic_draft_over_vtk", played.steady.wall_ms / vtk_ms);
      raise(report.summary, "clinic_first_ms", played.first.wall_ms);
      raise(report.summary, "clinic_bytes_per_voxel", per_voxel);
    }
  }
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
  if (std::error_code error; !std::filesystem::exists(kCtFile, error)) {
    options.tell(
        fmt::format("{} is missing: no clinic table; install Debian's package invesalius-examples", kCtFile));
    return {};
  }
  const TemporaryFolder folder;
  SPLATLAS_RETURN_IF_ERROR(build_head_ct({2, 2, 3}, folder.path(), options));
  SPLATLAS_RETURN_IF_ERROR(add_drafts(folder.path() / "2x2x3.atlas", options, report));
  SPLATLAS_RETURN_IF_ERROR(build_head_ct({1, 1, 1}, folder.path(), options));
  SPLATLAS_RETURN_IF_ERROR(build_head_ct({2, 2, 2}, folder.path(), options));
  return add_growth(folder.path() / "1x1x1.atlas", folder.path() / "2x2x2.atlas", options, report);
}

}  // namespace splatlas

// Bench `select`: time from a selection change to the first correct picture.
#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "bench/bench.h"
#include "bench/measure/frames.h"
#include "bench/measure/measure.h"
#include "bench/peers/x_server.h"
#include "bench/scenes/atlases.h"
#include "bench/scenes/participants.h"
#include "format/atlas_writer.h"
#include "format/result_macros.h"
#include "tests/support/temporary_folder.h"

namespace splatlas {
namespace {

constexpr PictureSize kSize{512, 512};
constexpr unsigned kThreads = 2;  // as VTK has
constexpr double kStepMm = 1;     // VTK sample distance: its default, one voxel

/// Transfer function of the changing selection.
constexpr ErrorAppearance kAppearance{"soft", "opacity=0.3,color=#ffffff"};

/// Rendering method: projection, classification and quality.
struct Method {
  const char* name;
  CameraProjection projection;
  Classification classification;
  Quality quality;
};
/// Methods: as VTK, the default, and as VolPack.
enum MethodNumber : std::size_t { kRays, kSheets, kDrafts };
constexpr std::array kMethods{
    Method{"perspective, post-classified", CameraProjection::kPerspective, Classification::kAfter,
           Quality::kNormal},
    Method{"parallel", CameraProjection::kParallel, Classification::kBefore, Quality::kNormal},
    Method{"parallel, draft", CameraProjection::kParallel, Classification::kBefore, Quality::kDraft}};
/// Summary keys of changes among decoded structures, by method.
constexpr std::array kFirstOverSteady{"rays_first_over_steady_max", "first_over_steady_max",
                                      "draft_first_over_steady_max"};

constexpr std::array kScenes{
    ErrorScene{"head", "Head", false},
    ErrorScene{"brain", "\"Left hemisphere\" + \"Right hemisphere\" + Vermis", false},
    ErrorScene{"left", "\"Left hemisphere\"", false},
    ErrorScene{"frontal", "\"Frontal lobe\"", false},
    ErrorScene{"cerebellum", "Cerebellum", false},
    ErrorScene{"one", "Hippocampus_L + Amygdala_L", false}};

/// Selects a scene and draws its first picture and the next one: two stages. Adds the number of values that
/// differ between the two.
Result<std::vector<Elapsed>> change_to(Renderer& renderer, const Selection& selection, const Method& method,
                                       std::uint64_t& differ) {
  const RenderOptions options{
      .size = kSize, .quality = method.quality, .classification = method.classification};
  Camera camera = oblique_camera();
  camera.projection = method.projection;
  camera.field_of_view_deg = kVerticalFovDeg;
  static thread_local Frame first, steady;  // pages exist, as in a window
  Stopwatch watch;
  SPLATLAS_RETURN_IF_ERROR(renderer.select(selection));
  SPLATLAS_RETURN_IF_ERROR(renderer.render(camera, options, first));
  const Elapsed select_and_first = watch.lap();
  SPLATLAS_RETURN_IF_ERROR(renderer.render(camera, options, steady));
  const Elapsed next = watch.lap();
  differ += bits_differ(first.picture.rgba, steady.picture.rgba);
  return std::vector{select_and_first, next};
}

/// Contenders: changes to each scene in turn. The renderer has decoded all of them.
Result<Table> measure_decoded(const std::shared_ptr<const Atlas>& atlas, std::span<const ErrorModel> models,
                              int turns, Report& report) {
  Table table{"decoded",
              "Selection change among structures already decoded, Colin 27, soft, lit, 512x512, 2 threads",
              {"first: from select() to the first picture; steady: the next picture of the same view",
               "ratio: by the wall clock, of minima over turns (first_over_steady_max: in parallel "
               "projection and normal quality, the default)"}};
  for (std::size_t w = 0; w < kMethods.size(); ++w) {
    const Method& method = kMethods[w];
    Renderer renderer(atlas, {.threads = kThreads});
    std::vector<Contender> contenders;
    std::uint64_t differ = 0;
    for (const ErrorModel& model : models) {
      contenders.emplace_back([&](int) { return change_to(renderer, model.selection, method, differ); });
      SPLATLAS_RETURN_IF_ERROR(contenders.back()(0));
    }
    SPLATLAS_ASSIGN_OR_RETURN(const std::vector<StageTimes> times, measure_interleaved(contenders, turns));
    for (std::size_t n = 0; n < models.size(); ++n) {
      const Elapsed first = best_of_repeats(times[n][0], 1)[0];
      const Elapsed steady = best_of_repeats(times[n][1], 1)[0];
      const double ratio = first.wall_ms / steady.wall_ms;
      table.rows.push_back({{"method", method.name},
                            {"scene", kScenes[n].name},
                            {"first_ms", first.wall_ms},
                            {"steady_ms", steady.wall_ms},
                            {"ratio", ratio},
                            {"first_cpu", first.cpu_ms},
                            {"steady_cpu", steady.cpu_ms},
                            {"cpu_ratio", first.cpu_ms / steady.cpu_ms}});
      raise(report.summary, kFirstOverSteady[w], ratio);
    }
    if (differ > 0)
      report.failures.push_back(fmt::format("{}: {} values of first pictures change", method.name, differ));
  }
  return table;
}

/// Look-up tables of masking, by class.
struct DrawnClasses {
  std::vector<std::uint8_t> drawn;  ///< 0xff for classes drawn as volume, otherwise 0
  std::vector<bool> lit;            ///< drawn, and on the boundary
};
DrawnClasses drawn_classes(const AtlasContent& content, const Atlas& atlas, const Selection& selection) {
  DrawnClasses classes{std::vector<std::uint8_t>(content.classes.size(), 0),
                       std::vector<bool>(content.classes.size(), false)};
  for (const ClassDraw& draw : atlas.tree().plan(selection).classes) {
    if (!draws_volume(draw.role)) continue;
    classes.drawn[draw.id] = 0xff;
    classes.lit[draw.id] = draw.boundary;
  }
  return classes;
}

/// Share of the peers in a change: the masked copy, one pass over all voxels.
void mask(const AtlasContent& content, const DrawnClasses& classes, reference::MaskedVolume& volume) {
  const auto* greys = content.values.as<std::uint8_t>();
  for (std::size_t n = 0; n < volume.greys.size(); ++n)
    volume.greys[n] = static_cast<std::uint8_t>(greys[n] & classes.drawn[content.class_volume[n]]);
}

/// The same for normals, of which VTK takes none. `all`: packed normals of all boundary voxels.
void mask_normals(const AtlasContent& content, const std::vector<std::int32_t>& all,
                  const DrawnClasses& classes, reference::MaskedVolume& volume) {
  using reference::MaskedVolume;
  for (std::size_t n = 0; n < volume.normals.size(); ++n) {
    const ClassId c = content.class_volume[n];
    volume.normals[n] = classes.lit[c]          ? all[n]
                        : classes.drawn[c] != 0 ? MaskedVolume::kUnlit
                                                : MaskedVolume::kOutside;
  }
}

/// Packed normals of all voxels of classes with a boundary, whatever is selected; 0 elsewhere.
std::vector<std::int32_t> all_normals(const AtlasContent& content) {
  std::vector<std::int32_t> normals(content.class_volume.size(), 0);
  std::vector<std::size_t> met(content.classes.size(), 0);  // voxels per class so far
  for (std::size_t n = 0; n < normals.size(); ++n) {
    const std::vector<PackedNormal>& of_class = content.boundary_normals[content.class_volume[n]];
    std::size_t& next = met[content.class_volume[n]];
    if (next < of_class.size()) normals[n] = of_class[next++];
  }
  return normals;
}

/// Peers in use, showing another selection at the start of the clock.
class Peers {
 public:
  Peers(const AtlasContent& content, const Atlas& atlas, const ErrorModel& first, const ParallelView& view)
      : content_(content),
        atlas_(atlas),
        view_(view),
        masked_(first.volume),
        normals_(all_normals(content)),
        vtk_(kSize) {
    vtk_.add_volume(masked_, first.appearance, VtkVolumeMapper::kFixedPoint, kStepMm);
    vtk_.shade_volumes(true);
  }

  /// Masks, uploads the masked copy and draws.
  Result<std::vector<Elapsed>> change_vtk(const ErrorModel& model) {
    const reference::PerspectiveView view{view_, kVerticalFovDeg};
    const DrawnClasses drawn = drawn_classes(content_, atlas_, model.selection);
    Stopwatch watch;
    mask(content_, drawn, masked_);
    vtk_.replace_volume(masked_);
    vtk_.render(view);
    const Elapsed first = watch.lap();
    vtk_.render(view);
    return std::vector{first, watch.lap()};
  }

  /// Masks, classifies into runs and draws.
  Result<std::vector<Elapsed>> change_volpack(const ErrorModel& model) {
    const DrawnClasses drawn = drawn_classes(content_, atlas_, model.selection);
    Stopwatch watch;
    mask(content_, drawn, masked_);
    mask_normals(content_, normals_, drawn, masked_);
    SPLATLAS_ASSIGN_OR_RETURN(
        VolpackPeer volpack,
        VolpackPeer::classify(masked_, model.appearance, OpacityRounding::kDown, VolpackShading::kHybrid));
    SPLATLAS_RETURN_IF_ERROR(volpack.render(view_));
    const Elapsed first = watch.lap();
    SPLATLAS_RETURN_IF_ERROR(volpack.render(view_));
    return std::vector{first, watch.lap()};
  }

 private:
  const AtlasContent& content_;
  const Atlas& atlas_;
  const ParallelView& view_;
  reference::MaskedVolume masked_;
  std::vector<std::int32_t> normals_;
  VtkPeer vtk_;
};

/// One scene by our methods, VTK and VolPack: times of the first pictures and the next ones.
constexpr std::size_t kVtk = kMethods.size(), kVolpack = kVtk + 1;
using FirstAndSteady = std::array<Elapsed, 2>;

Result<std::vector<FirstAndSteady>> measure_newly_read(const std::filesystem::path& path,
                                                       const ErrorModel& model, Peers& peers, int turns) {
  std::vector<Contender> contenders;
  for (const Method& method : kMethods) {
    contenders.emplace_back([&](int) -> Result<std::vector<Elapsed>> {
      // Open, with nothing read or decoded; as after another selection.
      SPLATLAS_ASSIGN_OR_RETURN(const std::shared_ptr<const Atlas> atlas, Atlas::open(path));
      Renderer renderer(atlas, {.threads = kThreads});
      std::uint64_t differ = 0;
      return change_to(renderer, model.selection, method, differ);
    });
  }
  contenders.emplace_back([&](int) { return peers.change_vtk(model); });
  contenders.emplace_back([&](int) { return peers.change_volpack(model); });
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<StageTimes> times, measure_interleaved(contenders, turns));
  std::vector<FirstAndSteady> taken;
  for (const StageTimes& stages : times)
    taken.push_back({best_of_repeats(stages[0], 1)[0], best_of_repeats(stages[1], 1)[0]});
  return taken;
}

void add_rows(const char* scene, const std::vector<FirstAndSteady>& taken, Table& table) {
  constexpr std::array kPeers{"VTK FixedPoint", "VolPack"};
  for (std::size_t n = 0; n < taken.size(); ++n) {
    const bool is_peer = n >= kMethods.size();
    const auto& [first, steady] = taken[n];
    table.rows.push_back({{"scene", scene},
                          {"renderer", is_peer ? kPeers[n - kMethods.size()] : "splatlas"},
                          {"method", is_peer ? "" : kMethods[n].name},
                          {"first_ms", first.wall_ms},
                          {"first_cpu", first.cpu_ms},
                          {"steady_ms", steady.wall_ms},
                          {"over_fixedpoint", first.wall_ms / taken[kVtk][0].wall_ms},
                          {"over_volpack", first.wall_ms / taken[kVolpack][0].wall_ms}});
  }
}

Result<Table> measure_reading(const AtlasContent& content, const std::shared_ptr<const Atlas>& atlas,
                              std::span<const ErrorModel> models, int turns, const BenchOptions& options,
                              Report& report) {
  Table table{
      "newly read",
      "Selection change to structures not yet read from the file, Colin 27, soft, lit, 512x512",
      {"first: from select() to the first picture, the file open and in the system's cache, nothing "
       "decoded; peers: from masking to the first picture; minima over turns",
       "VTK FixedPoint: mask, upload, draw in perspective at steps of 1 mm; VolPack: mask, classify, "
       "draw, one thread",
       "select_vs_fixedpoint_max: our rays, which draw what VTK draws; select_vs_volpack_max: our drafts, as "
       "VolPack in parallel projection and more accurate (bench error); by the wall clock"}};
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "select.atlas";
  SPLATLAS_RETURN_IF_ERROR(write_atlas(content, path));
  SPLATLAS_ASSIGN_OR_RETURN(const ParallelView view,
                            parallel_view(oblique_camera(), kSize, atlas->display()));
  Peers peers(content, *atlas, models[0], view);
  for (std::size_t n = 0; n < models.size(); ++n) {
    options.tell(fmt::format("newly read: {}", kScenes[n].name));
    SPLATLAS_ASSIGN_OR_RETURN(const std::vector<FirstAndSteady> taken,
                              measure_newly_read(path, models[n], peers, turns));
    add_rows(kScenes[n].name, taken, table);
    const auto over = [&](std::size_t ours, std::size_t theirs) {
      return taken[ours][0].wall_ms / taken[theirs][0].wall_ms;
    };
    raise(report.summary, "select_vs_fixedpoint_max", over(kRays, kVtk));
    raise(report.summary, "select_parallel_vs_fixedpoint_max", over(kSheets, kVtk));
    raise(report.summary, "select_vs_volpack_max", over(kDrafts, kVolpack));
    raise(report.summary, "select_normal_vs_volpack_max", over(kSheets, kVolpack));
  }
  return table;
}

}  // namespace

Result<Report> run_select_bench(const BenchOptions& options) {
  Report report;
  SPLATLAS_ASSIGN_OR_RETURN(const XServer display, start_x_server());
  SPLATLAS_ASSIGN_OR_RETURN(const std::shared_ptr<const Atlas> atlas, open_colin27(options));
  SPLATLAS_ASSIGN_OR_RETURN(const AtlasContent content, atlas->read_all());
  std::vector<ErrorModel> models;
  for (const ErrorScene& scene : kScenes) {
    SPLATLAS_ASSIGN_OR_RETURN(models.emplace_back(), error_model(content, scene, kAppearance));
  }
  options.tell("among decoded structures");
  SPLATLAS_ASSIGN_OR_RETURN(report.tables.emplace_back(),
                            measure_decoded(atlas, models, options.quick ? 7 : 31, report));
  SPLATLAS_ASSIGN_OR_RETURN(report.tables.emplace_back(),
                            measure_reading(content, atlas, models, options.quick ? 3 : 9, options, report));
  return report;
}

}  // namespace splatlas

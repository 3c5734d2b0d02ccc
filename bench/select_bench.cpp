// Bench `select`: time from a selection change to the first correct picture.
#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "bench/atlases.h"
#include "bench/bench.h"
#include "bench/error_participants.h"
#include "bench/frames.h"
#include "bench/measure.h"
#include "bench/peers/x_server.h"
#include "bench/scratch_folder.h"
#include "format/atlas_writer.h"
#include "format/system/result_macros.h"

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

RenderOptions render_options(const Method& method) {
  RenderOptions options;
  options.size = kSize;
  options.hybrid_shading = false;
  options.classification = method.classification;
  options.quality = method.quality;
  return options;
}

Camera with_method(Camera camera, const Method& method) {
  camera.projection = method.projection;
  camera.field_of_view_deg = kVerticalFovDeg;
  return camera;
}

struct SelectTask {
  std::vector<std::string> names;
  std::vector<ErrorModel> models;  ///< scenes with a common view
  Camera camera;
};

constexpr std::array kScenes{
    ErrorScene{"head", "Head", false},
    ErrorScene{"brain", "\"Left hemisphere\" + \"Right hemisphere\" + Vermis", false},
    ErrorScene{"left", "\"Left hemisphere\"", false},
    ErrorScene{"frontal", "\"Frontal lobe\"", false},
    ErrorScene{"cerebellum", "Cerebellum", false},
    ErrorScene{"one", "Hippocampus_L + Amygdala_L", false}};

Result<SelectTask> make_task(const AtlasContent& content) {
  SelectTask task;
  for (const ErrorScene& scene : kScenes) {
    SPLATLAS_ASSIGN_OR_RETURN(ErrorModel model, error_model(content, scene, kAppearance));
    task.camera = model.camera;
    task.names.emplace_back(scene.name);
    task.models.push_back(std::move(model));
  }
  return task;
}

/// Selects a scene and draws its first picture and the next one.
struct Change {
  Elapsed select_and_first, steady;
  std::uint64_t bits_differ = 0;  ///< between the two pictures
};

Result<Change> change_to(Renderer& renderer, const Selection& selection, const Camera& camera,
                         const Method& method) {
  const RenderOptions options = render_options(method);
  static thread_local Picture first, steady;  // pages exist, as in a window
  Change change;
  Stopwatch watch;
  SPLATLAS_RETURN_IF_ERROR(renderer.select(selection));
  SPLATLAS_RETURN_IF_ERROR(renderer.render(with_method(camera, method), options, first));
  change.select_and_first = watch.lap();
  SPLATLAS_RETURN_IF_ERROR(renderer.render(with_method(camera, method), options, steady));
  change.steady = watch.lap();
  change.bits_differ = bits_differ(first.rgba, steady.rgba);
  return change;
}

/// Contenders: changes to each scene in turn. The renderer has decoded all of them.
Result<Table> measure_decoded(const std::shared_ptr<const Atlas>& atlas, const SelectTask& task, int turns,
                              Report& report) {
  Table table{"decoded",
              "Selection change among structures already decoded, Colin 27, soft, 512x512, 2 threads",
              {"first: from select() to the first picture; steady: the next picture of the same view",
               "ratio: by the wall clock, of minima over turns (first_over_steady_max: in parallel "
               "projection and normal quality, the default)"},
              {}};
  for (std::size_t w = 0; w < kMethods.size(); ++w) {
    const Method& method = kMethods[w];
    Renderer renderer(atlas, {.threads = kThreads});
    std::vector<Contender> contenders;
    std::uint64_t differ = 0;
    for (const ErrorModel& model : task.models) {
      SPLATLAS_RETURN_IF_ERROR(change_to(renderer, model.selection, task.camera, method));
      contenders.emplace_back([&](int) -> Result<std::vector<Elapsed>> {
        SPLATLAS_ASSIGN_OR_RETURN(const Change change,
                                  change_to(renderer, model.selection, task.camera, method));
        differ += change.bits_differ;
        return std::vector{change.select_and_first, change.steady};
      });
    }
    SPLATLAS_ASSIGN_OR_RETURN(const std::vector<StageTimes> times, measure_interleaved(contenders, turns));
    for (std::size_t n = 0; n < task.models.size(); ++n) {
      const Elapsed first = best_of_repeats(times[n][0], 1)[0];
      const Elapsed steady = best_of_repeats(times[n][1], 1)[0];
      const double ratio = first.wall_ms / steady.wall_ms;
      table.rows.push_back({{"method", method.name},
                            {"scene", task.names[n]},
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

/// The classes that a selection draws as volume: look-up table of masking.
std::vector<std::uint8_t> drawn_classes(const AtlasContent& content, const Atlas& atlas,
                                        const Selection& selection) {
  std::vector<std::uint8_t> drawn(content.classes.size(), 0);
  for (const ClassDraw& draw : atlas.tree().plan(selection).classes) {
    if (draws_volume(draw.role)) drawn[draw.id] = 0xff;
  }
  return drawn;
}

/// Share of the peers in a change: the masked copy, one pass over all voxels.
void mask(const AtlasContent& content, const std::vector<std::uint8_t>& drawn,
          reference::MaskedVolume& volume) {
  const auto* greys = content.values.as<std::uint8_t>();
  for (std::size_t n = 0; n < volume.greys.size(); ++n) {
    volume.greys[n] = static_cast<std::uint8_t>(greys[n] & drawn[content.class_volume[n]]);
  }
}

/// Peers in use, showing another selection at the start of the clock.
class Peers {
 public:
  Peers(const AtlasContent& content, const std::shared_ptr<const Atlas>& atlas, const SelectTask& task)
      : content_(content), atlas_(atlas), task_(task), masked_(task.models[0].volume), vtk_(kSize) {
    vtk_.add_volume(masked_, task.models[0].appearance, VtkVolumeMapper::kFixedPoint, kStepMm);
  }

  /// Masks, uploads the masked copy and draws.
  Result<std::vector<Elapsed>> change_vtk(const ErrorModel& model) {
    SPLATLAS_ASSIGN_OR_RETURN(const ParallelView view, parallel_view(task_.camera, kSize, atlas_->display()));
    const reference::PerspectiveView perspective{view, kVerticalFovDeg};
    const std::vector<std::uint8_t> drawn = drawn_classes(content_, *atlas_, model.selection);
    Stopwatch watch;
    mask(content_, drawn, masked_);
    vtk_.replace_volume(masked_);
    vtk_.render(perspective);
    const Elapsed first = watch.lap();
    vtk_.render(perspective);
    return std::vector{first, watch.lap()};
  }

  /// Masks, classifies into runs and draws.
  Result<std::vector<Elapsed>> change_volpack(const ErrorModel& model) {
    SPLATLAS_ASSIGN_OR_RETURN(const ParallelView view, parallel_view(task_.camera, kSize, atlas_->display()));
    const std::vector<std::uint8_t> drawn = drawn_classes(content_, *atlas_, model.selection);
    Stopwatch watch;
    mask(content_, drawn, masked_);
    SPLATLAS_ASSIGN_OR_RETURN(VolpackPeer volpack,
                              VolpackPeer::classify(masked_, model.appearance, OpacityRounding::kDown));
    SPLATLAS_RETURN_IF_ERROR(volpack.render(view));
    const Elapsed first = watch.lap();
    SPLATLAS_RETURN_IF_ERROR(volpack.render(view));
    return std::vector{first, watch.lap()};
  }

 private:
  const AtlasContent& content_;
  std::shared_ptr<const Atlas> atlas_;
  const SelectTask& task_;
  reference::MaskedVolume masked_;
  VtkPeer vtk_;
};

/// One scene by our methods, VTK and VolPack.
constexpr std::size_t kVtk = kMethods.size(), kVolpack = kVtk + 1;
struct NewlyRead {
  std::array<Elapsed, kMethods.size() + 2> first, steady;
};

Result<NewlyRead> measure_newly_read(const std::filesystem::path& path, const ErrorModel& model,
                                     const SelectTask& task, Peers& peers, int turns) {
  std::vector<Contender> contenders;
  for (const Method& method : kMethods) {
    contenders.emplace_back([&](int) -> Result<std::vector<Elapsed>> {
      // Open, with nothing read or decoded; as after another selection.
      SPLATLAS_ASSIGN_OR_RETURN(const std::shared_ptr<const Atlas> atlas, Atlas::open(path));
      Renderer renderer(atlas, {.threads = kThreads});
      SPLATLAS_ASSIGN_OR_RETURN(const Change change,
                                change_to(renderer, model.selection, task.camera, method));
      return std::vector{change.select_and_first, change.steady};
    });
  }
  contenders.emplace_back([&](int) { return peers.change_vtk(model); });
  contenders.emplace_back([&](int) { return peers.change_volpack(model); });
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<StageTimes> times, measure_interleaved(contenders, turns));
  NewlyRead result;
  for (std::size_t n = 0; n < times.size(); ++n) {
    result.first[n] = best_of_repeats(times[n][0], 1)[0];
    result.steady[n] = best_of_repeats(times[n][1], 1)[0];
  }
  return result;
}

void add_rows(const std::string& scene, const NewlyRead& taken, Table& table) {
  constexpr std::array kPeers{"VTK FixedPoint", "VolPack"};
  for (std::size_t n = 0; n < taken.first.size(); ++n) {
    const bool is_peer = n >= kMethods.size();
    table.rows.push_back({{"scene", scene},
                          {"renderer", is_peer ? kPeers[n - kMethods.size()] : "splatlas"},
                          {"method", is_peer ? "" : kMethods[n].name},
                          {"first_ms", taken.first[n].wall_ms},
                          {"first_cpu", taken.first[n].cpu_ms},
                          {"steady_ms", taken.steady[n].wall_ms},
                          {"over_fixedpoint", taken.first[n].wall_ms / taken.first[kVtk].wall_ms},
                          {"over_volpack", taken.first[n].wall_ms / taken.first[kVolpack].wall_ms}});
  }
}

Result<Table> measure_reading(const AtlasContent& content, const std::shared_ptr<const Atlas>& atlas,
                              const SelectTask& task, int turns, const BenchOptions& options,
                              Report& report) {
  Table table{
      "newly read",
      "Selection change to structures not yet read from the file, Colin 27, soft, 512x512",
      {"first: from select() to the first picture, the file open and in the system's cache, nothing "
       "decoded; peers: from masking to the first picture; minima over turns",
       "VTK FixedPoint: mask, upload, draw in perspective at steps of 1 mm; VolPack: mask, classify, "
       "draw, one thread",
       "select_vs_fixedpoint_max: our rays, which draw what VTK draws; select_vs_volpack_max: our drafts, as "
       "VolPack in parallel projection and more accurate (bench error); by the wall clock"},
      {}};
  SPLATLAS_ASSIGN_OR_RETURN(const ScratchFolder folder, ScratchFolder::make());
  const std::filesystem::path path = folder.path() / "select.atlas";
  SPLATLAS_RETURN_IF_ERROR(write_atlas(content, path));
  Peers peers(content, atlas, task);
  for (std::size_t n = 0; n < task.models.size(); ++n) {
    options.tell(fmt::format("newly read: {}", task.names[n]));
    SPLATLAS_ASSIGN_OR_RETURN(const NewlyRead taken,
                              measure_newly_read(path, task.models[n], task, peers, turns));
    add_rows(task.names[n], taken, table);
    const auto over = [&](std::size_t ours, std::size_t theirs) {
      return taken.first[ours].wall_ms / taken.first[theirs].wall_ms;
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
  SPLATLAS_ASSIGN_OR_RETURN(const SelectTask task, make_task(content));
  options.tell("among decoded structures");
  SPLATLAS_ASSIGN_OR_RETURN(Table decoded, measure_decoded(atlas, task, options.quick ? 7 : 31, report));
  report.tables.push_back(std::move(decoded));
  SPLATLAS_ASSIGN_OR_RETURN(Table reading,
                            measure_reading(content, atlas, task, options.quick ? 3 : 9, options, report));
  report.tables.push_back(std::move(reading));
  return report;
}

}  // namespace splatlas

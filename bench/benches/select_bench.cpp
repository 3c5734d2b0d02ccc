// Bench `select`: time from a selection change to the first correct picture.
#include <array>
#include <memory>
#include <vector>

#include <fmt/format.h>

#include "bench/bench.h"
#include "bench/measure/frames.h"
#include "bench/measure/measure.h"
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
                                       std::uint64_t& differ, bool lit = true) {
  const RenderOptions options{.size = kSize,
                              .quality = method.quality,
                              .classification = method.classification,
                              .hybrid_shading = lit};
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
                            {"ratio", ratio}});
      raise(report.summary, kFirstOverSteady[w], ratio);
    }
    if (differ > 0)
      report.failures.push_back(fmt::format("{}: {} values of first pictures change", method.name, differ));
  }
  return table;
}

/// Changes of mode, opacity and colour of one structure of the whole head; and the head after another
/// selection, lit and unlit. All is decoded.
Result<Table> measure_head(const std::shared_ptr<const Atlas>& atlas, int turns,
                           nlohmann::ordered_json& summary) {
  Table table{"head",
              "Changes of one structure of the head, and the whole head, 512x512, 2 threads",
              {"first: from select() to the first picture; steady: the next one; minima over turns"}};
  SPLATLAS_ASSIGN_OR_RETURN(const Selection head,
                            Selection::parse("Head:volume(opacity=0.3)", atlas->graph()));
  SPLATLAS_ASSIGN_OR_RETURN(const Selection other, Selection::parse("Cerebellum", atlas->graph()));
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<StructureIndex> found, atlas->graph().find("Precentral_L"));
  Selection mode = head, opacity = head, color = head;
  mode.structures[found.front()].mode = DrawMode::kBoth;
  opacity.structures[found.front()].opacity = 0.6f;
  color.structures[found.front()].color = {255, 0, 0};
  struct Change {
    const char* name;
    const Selection &from, &to;
    bool lit = true;
  };
  const std::array changes{Change{"mode", head, mode}, Change{"opacity", head, opacity},
                           Change{"colour", head, color}, Change{"head", other, head},
                           Change{"head, unlit", other, head, false}};
  Renderer renderer(atlas, {.threads = kThreads});
  std::uint64_t differ = 0;
  std::vector<Contender> contenders;
  for (const Change& change : changes) {
    contenders.emplace_back([&](int) -> Result<std::vector<Elapsed>> {
      SPLATLAS_RETURN_IF_ERROR(change_to(renderer, change.from, kMethods[kSheets], differ, change.lit));
      return change_to(renderer, change.to, kMethods[kSheets], differ, change.lit);
    });
  }
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<StageTimes> times, measure_interleaved(contenders, turns));
  for (std::size_t n = 0; n < changes.size(); ++n) {
    const double first = best_of_repeats(times[n][0], 1)[0].wall_ms;
    const double steady = best_of_repeats(times[n][1], 1)[0].wall_ms;
    table.rows.push_back({{"change", changes[n].name}, {"first_ms", first}, {"steady_ms", steady}});
    if (n < 3) raise(summary, "one_structure_over_steady_max", first / steady);
  }
  summary["first_lit_over_unlit_head"] =
      table.rows[3]["first_ms"].get<double>() / table.rows[4]["first_ms"].get<double>();
  return table;
}

/// Share of the peers in a change: the masked copy. Per class, 0xff if it is drawn, otherwise 0.
std::vector<std::uint8_t> drawn_classes(const Atlas& atlas, const Selection& selection) {
  std::vector<std::uint8_t> drawn(atlas.classes().size(), 0);
  for (const ClassDraw& draw : atlas.tree().plan(selection).classes) {
    if (draws_volume(draw.role)) drawn[draw.id] = 0xff;
  }
  return drawn;
}

/// Peers in use, showing another selection at the start of the clock. The first one has all normals.
class Peers {
 public:
  Peers(const AtlasContent& content, const Atlas& atlas, const ErrorModel& first, const ParallelView& view)
      : content_(content),
        atlas_(atlas),
        view_(view),
        all_(first.volume),
        masked_(first.volume),
        vtk_(kSize) {
    vtk_.add_volume(masked_, first.appearance, VtkVolumeMapper::kFixedPoint, kStepMm);
    vtk_.shade_volumes(true);
  }

  /// Masks, uploads the masked copy and draws.
  Result<void> change_vtk(const ErrorModel& model) {
    mask_greys(model.selection);
    vtk_.replace_volume(masked_);
    vtk_.render(reference::PerspectiveView{view_, kVerticalFovDeg});
    return {};
  }

  /// Masks, classifies into runs and draws.
  Result<void> change_volpack(const ErrorModel& model) {
    const std::vector<std::uint8_t> drawn = mask_greys(model.selection);
    for (std::size_t n = 0; n < masked_.normals.size(); ++n) {  // VTK takes none
      masked_.normals[n] =
          drawn[content_.class_volume[n]] != 0 ? all_.normals[n] : reference::MaskedVolume::kOutside;
    }
    SPLATLAS_ASSIGN_OR_RETURN(VolpackPeer volpack, VolpackPeer::classify(masked_, model.appearance));
    return volpack.render(view_);
  }

 private:
  std::vector<std::uint8_t> mask_greys(const Selection& selection) {
    std::vector<std::uint8_t> drawn = drawn_classes(atlas_, selection);
    const auto* greys = content_.values.as<std::uint8_t>();
    for (std::size_t n = 0; n < masked_.greys.size(); ++n)
      masked_.greys[n] = static_cast<std::uint8_t>(greys[n] & drawn[content_.class_volume[n]]);
    return drawn;
  }

  const AtlasContent& content_;
  const Atlas& atlas_;
  const ParallelView& view_;
  const reference::MaskedVolume& all_;
  reference::MaskedVolume masked_;
  VtkPeer vtk_;
};

/// Contenders of one scene: our methods, VTK and VolPack.
constexpr std::size_t kVtk = kMethods.size(), kVolpack = kVtk + 1;
constexpr std::array kContenders{"splatlas, perspective, post-classified", "splatlas, parallel",
                                 "splatlas, parallel, draft", "VTK FixedPoint", "VolPack"};

/// First pictures of one scene, the fastest turn of each contender.
Result<std::vector<Elapsed>> measure_newly_read(const std::filesystem::path& path, const ErrorModel& model,
                                                Peers& peers, int turns) {
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
  contenders.push_back(timed([&](int) { return peers.change_vtk(model); }));
  contenders.push_back(timed([&](int) { return peers.change_volpack(model); }));
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<StageTimes> times, measure_interleaved(contenders, turns));
  std::vector<Elapsed> firsts;
  for (const StageTimes& stages : times) firsts.push_back(best_of_repeats(stages[0], 1)[0]);
  return firsts;
}

Result<Table> measure_reading(const AtlasContent& content, const std::shared_ptr<const Atlas>& atlas,
                              std::span<const ErrorModel> models, int turns, const BenchOptions& options,
                              Report& report) {
  Table table{"newly read",
              "Selection change to structures not yet read from the file, Colin 27, soft, lit, 512x512",
              {"first: from select() to the first picture, the file open and in the system's cache, nothing "
               "decoded; peers: from masking to the first picture; minima over turns"}};
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "select.atlas";
  SPLATLAS_RETURN_IF_ERROR(write_atlas(content, path));
  SPLATLAS_ASSIGN_OR_RETURN(const ParallelView view,
                            parallel_view(oblique_camera(), kSize, atlas->display()));
  Peers peers(content, *atlas, models[0], view);
  for (std::size_t n = 0; n < models.size(); ++n) {
    options.tell(fmt::format("newly read: {}", kScenes[n].name));
    SPLATLAS_ASSIGN_OR_RETURN(const std::vector<Elapsed> firsts,
                              measure_newly_read(path, models[n], peers, turns));
    for (std::size_t c = 0; c < firsts.size(); ++c) {
      table.rows.push_back({{"scene", kScenes[n].name},
                            {"renderer", kContenders[c]},
                            {"first_ms", firsts[c].wall_ms},
                            {"first_cpu", firsts[c].cpu_ms},
                            {"over_fixedpoint", firsts[c].wall_ms / firsts[kVtk].wall_ms},
                            {"over_volpack", firsts[c].wall_ms / firsts[kVolpack].wall_ms}});
    }
    raise(report.summary, "select_vs_fixedpoint_max", firsts[kRays].wall_ms / firsts[kVtk].wall_ms);
    raise(report.summary, "select_vs_volpack_max", firsts[kDrafts].wall_ms / firsts[kVolpack].wall_ms);
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
                            measure_head(atlas, options.quick ? 5 : 15, report.summary));
  SPLATLAS_ASSIGN_OR_RETURN(report.tables.emplace_back(),
                            measure_reading(content, atlas, models, options.quick ? 3 : 9, options, report));
  return report;
}

}  // namespace splatlas

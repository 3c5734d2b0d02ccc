// Bench `skip`: cost against the selected fraction, and selections against atlases of nothing else.
#include <algorithm>
#include <array>
#include <memory>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "bench/bench.h"
#include "bench/experiments/changed_content.h"
#include "bench/measure/frames.h"
#include "bench/measure/measure.h"
#include "bench/scenes/atlases.h"
#include "bench/scenes/error_scenes.h"
#include "format/atlas_writer.h"
#include "format/result_macros.h"
#include "player/renderer.h"

namespace splatlas {
namespace {

constexpr PictureSize kSize{512, 512};
constexpr const char* kAppearance = "opacity=0.3,color=#ffffff";

constexpr int kIsolationTurns = 6;  // factor, to separate the difference of two atlases from noise

struct Effort {
  int frames = 7, repeats = 3;
  StructureIndex every = 1;  // n-th structure

  [[nodiscard]] int turns() const { return frames * repeats; }
};

/// Ratio of CPU times: minimum over repeats of each frame, median over frames.
double ratio(const StageTimes& times, const StageTimes& unit, const Effort& effort) {
  return median_ratio(best_of_repeats(times[0], effort.frames), best_of_repeats(unit[0], effort.frames))
      .cpu_ms;
}

/// A turning selection on one thread. Spans of all axes exist ahead of measurements.
class Turning {
 public:
  Turning(const std::shared_ptr<const Atlas>& atlas, const Effort& effort)
      : renderer_(std::make_unique<Renderer>(atlas, RendererOptions{.threads = 1})), effort_(effort) {}

  Result<void> select(const Selection& selection) {
    SPLATLAS_RETURN_IF_ERROR(renderer_->select(selection));
    SPLATLAS_ASSIGN_OR_RETURN(
        const std::vector<Camera> cameras,
        cameras_by_axis(oblique_camera(), effort_.turns(), effort_.frames, renderer_->atlas()));
    for (const Camera& camera : cameras) SPLATLAS_RETURN_IF_ERROR(draw(camera));
    return {};
  }

  [[nodiscard]] Contender contender() {
    return timed([this](int turn) { return draw(turned(oblique_camera(), turn, effort_.frames)); });
  }

  /// Half of the selection, seen from the cut, over the whole, at 1920x1080.
  Result<void> measure_cuts(nlohmann::ordered_json& summary) {
    for (const auto& [side, view] :
         {std::pair("left", NamedView::kLeft), {"superior", NamedView::kSuperior}}) {
      const auto draw = [this, view = view](const CutPlanes& cuts) {
        const RenderOptions options{.size = {1920, 1080}, .cuts = cuts};
        return timed([=, this](int) { return renderer_->render(Camera::of(view), options, frame_); });
      };
      const std::array contenders{draw({}), draw(*parse_cuts(fmt::format("{}=0", side)))};
      SPLATLAS_ASSIGN_OR_RETURN(const auto times, measure_interleaved(contenders, effort_.turns()));
      summary[fmt::format("cut_{}_normal", side)] = ratio(times[1], times[0], effort_);
    }
    return {};
  }
  [[nodiscard]] std::uint64_t visible_voxels() const { return frame_.stats.voxels_visited; }
  [[nodiscard]] const Picture& picture() const { return frame_.picture; }

 private:
  Result<void> draw(const Camera& camera) { return renderer_->render(camera, {.size = kSize}, frame_); }

  std::unique_ptr<Renderer> renderer_;
  Effort effort_;
  Frame frame_;
};

/// Every structure alone, groups with their descendants, beside the whole head and nothing.
Result<Table> measure_skipping(const std::shared_ptr<const Atlas>& atlas, const Effort& effort,
                               const BenchOptions& options, nlohmann::ordered_json& summary) {
  Table table{"skip",
              "Cost against what is selected: volumes of Colin 27, soft, 512x512, normal quality, one thread",
              {"over_all: CPU time over that of the whole head; empty_over_all: the same of nothing",
               "excess: over_all less 1.15 x visible_fraction less empty_over_all; the largest first"}};
  std::vector<Turning> turning;  // everything, nothing, a structure
  std::vector<Contender> contenders;
  for (std::size_t n = 0; n < 3; ++n) turning.emplace_back(atlas, effort);
  for (Turning& each : turning) contenders.push_back(each.contender());
  const StructureGraph& graph = atlas->graph();
  SPLATLAS_ASSIGN_OR_RETURN(const Selection all,
                            Selection::parse(selection_text("Head", kAppearance), graph));
  Selection nothing;
  nothing.structures.resize(graph.size());
  SPLATLAS_RETURN_IF_ERROR(turning[0].select(all));
  SPLATLAS_RETURN_IF_ERROR(turning[1].select(nothing));
  std::vector<double> empties;
  for (StructureIndex s = 0; s < graph.size(); s += effort.every) {
    options.tell(graph[s].id);
    Selection selection = nothing;
    for (const StructureIndex below : graph.descendants(s)) {
      selection.structures[below] = {.mode = DrawMode::kVolume, .opacity = 0.3f, .color = {255, 255, 255}};
    }
    SPLATLAS_RETURN_IF_ERROR(turning[2].select(selection));
    SPLATLAS_ASSIGN_OR_RETURN(const std::vector<StageTimes> times,
                              measure_interleaved(contenders, effort.turns()));
    const double empty = ratio(times[1], times[0], effort), over_all = ratio(times[2], times[0], effort);
    const double fraction =
        static_cast<double>(turning[2].visible_voxels()) / static_cast<double>(turning[0].visible_voxels());
    const double excess = over_all - 1.15 * fraction - empty;
    table.rows.push_back({{"structure", graph[s].id},
                          {"visible_fraction", fraction},
                          {"over_all", over_all},
                          {"empty_over_all", empty},
                          {"excess", excess}});
    empties.push_back(empty);
    raise(summary, "skip_excess_max", excess);
  }
  summary["empty_over_all"] = median(empties);
  SPLATLAS_RETURN_IF_ERROR(turning[0].measure_cuts(summary));
  std::stable_sort(table.rows.begin(), table.rows.end(),
                   [](const Row& a, const Row& b) { return a["excess"] > b["excess"]; });
  return table;
}

constexpr std::array kIsolated{"Head",  "Cerebellum",       "Precentral_L",
                               "Brain", "\"Frontal lobe\"", "Caudate_R"};

Result<Table> measure_isolation(const AtlasContent& content, const Effort& effort,
                                const BenchOptions& options, Report& report) {
  Table table{"isolation",
              "Selections in the full atlas against atlases of those structures alone",
              {"time: CPU time in the full atlas over that in the small one, one thread",
               "bytes: of chunks read from either file for all views, its directory left out"}};
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<std::byte> full_bytes, encode_atlas(content));
  for (std::size_t n = 0; n < kIsolated.size(); n += options.quick ? 2 : 1) {
    options.tell(fmt::format("isolated: {}", kIsolated[n]));
    SPLATLAS_ASSIGN_OR_RETURN(const Selection selection,
                              Selection::parse(selection_text(kIsolated[n], kAppearance), content.graph));
    SPLATLAS_ASSIGN_OR_RETURN(const std::shared_ptr<const Atlas> full, Atlas::open_bytes(full_bytes));
    SPLATLAS_ASSIGN_OR_RETURN(std::vector<std::byte> bytes_alone, encode_atlas(isolated(content, selection)));
    SPLATLAS_ASSIGN_OR_RETURN(const std::shared_ptr<const Atlas> alone,
                              Atlas::open_bytes(std::move(bytes_alone)));
    std::vector<Turning> turning;
    turning.emplace_back(full, effort);
    turning.emplace_back(alone, effort);
    std::array<std::uint64_t, 2> read{};  // bytes of chunks for all views
    for (std::size_t a = 0; a < 2; ++a) {
      const Atlas& atlas = a == 0 ? *full : *alone;
      const std::uint64_t before = atlas.counters().read;
      SPLATLAS_RETURN_IF_ERROR(turning[a].select(selection));
      read[a] = atlas.counters().read - before;
    }
    const std::vector<Contender> contenders{turning[0].contender(), turning[1].contender()};
    SPLATLAS_ASSIGN_OR_RETURN(const std::vector<StageTimes> times,
                              measure_interleaved(contenders, kIsolationTurns * effort.turns()));
    const double time = ratio(times[0], times[1], effort);
    const double bytes = static_cast<double>(read[0]) / static_cast<double>(read[1]);
    const std::uint64_t differ = bits_differ(turning[0].picture().rgba, turning[1].picture().rgba);
    table.rows.push_back({{"selection", kIsolated[n]},
                          {"visible_voxels", turning[0].visible_voxels()},
                          {"time", time},
                          {"bytes_read", read[0]},
                          {"alone_bytes_read", read[1]},
                          {"bytes", bytes},
                          {"bits_differ", differ}});
    raise(report.summary, "isolation_time_max", time);
    raise(report.summary, "isolation_bytes_max", bytes);
    if (differ > 0) {
      report.failures.push_back(
          fmt::format("{}: {} values are not those of the atlas without the rest", kIsolated[n], differ));
    }
  }
  return table;
}

}  // namespace

Result<Report> run_skip_bench(const BenchOptions& options) {
  Report report;
  const Effort effort = options.quick ? Effort{.frames = 3, .repeats = 2, .every = 5} : Effort{};
  SPLATLAS_ASSIGN_OR_RETURN(const std::shared_ptr<const Atlas> atlas, open_colin27(options));
  SPLATLAS_ASSIGN_OR_RETURN(report.tables.emplace_back(),
                            measure_skipping(atlas, effort, options, report.summary));
  SPLATLAS_ASSIGN_OR_RETURN(const AtlasContent content, atlas->read_all());
  SPLATLAS_ASSIGN_OR_RETURN(report.tables.emplace_back(),
                            measure_isolation(content, effort, options, report));
  return report;
}

}  // namespace splatlas

// Bench `skip`: cost against the selected fraction, and selections against atlases of nothing else.
#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "bench/bench.h"
#include "bench/measure/frames.h"
#include "bench/measure/isolated.h"
#include "bench/measure/measure.h"
#include "bench/scenes/atlases.h"
#include "bench/scenes/error_scenes.h"
#include "bench/scenes/skip_selections.h"
#include "format/atlas_writer.h"
#include "format/result_macros.h"
#include "player/renderer.h"

namespace splatlas {
namespace {

constexpr PictureSize kSize{512, 512};
constexpr const char* kAppearance = "opacity=0.3,color=#ffffff";
constexpr std::size_t kAtOnce = 16;  // selections measured interleaved with all and with nothing

/// Factor of turns for comparisons of two atlases, to separate their difference from noise.
constexpr int kIsolationTurns = 6;

struct Effort {
  int frames = 7, repeats = 3;
  std::size_t unions = 24;
  std::size_t every = 1;  // n-th selection

  [[nodiscard]] int turns() const { return frames * repeats; }
};

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

  [[nodiscard]] std::uint64_t visible_voxels() const { return frame_.stats.voxels_visited; }
  [[nodiscard]] const Picture& picture() const { return frame_.picture; }

 private:
  Result<void> draw(const Camera& camera) { return renderer_->render(camera, {.size = kSize}, frame_); }

  std::unique_ptr<Renderer> renderer_;
  Effort effort_;
  Frame frame_;
};

/// Ratio of CPU times: minimum over repeats of each frame, median over frames.
double ratio(const StageTimes& times, const StageTimes& unit, const Effort& effort) {
  return median_ratio(best_of_repeats(times[0], effort.frames), best_of_repeats(unit[0], effort.frames))
      .cpu_ms;
}

/// One batch of selections, beside everything and nothing.
Result<void> measure_batch(const std::shared_ptr<const Atlas>& atlas, const Selection& all,
                           std::span<const NamedSelection> batch, const Effort& effort, Table& table,
                           nlohmann::ordered_json& summary) {
  std::vector<Turning> turning;
  for (std::size_t n = 0; n < batch.size() + 2; ++n) turning.emplace_back(atlas, effort);
  Selection nothing;
  nothing.structures.resize(atlas->graph().size());
  SPLATLAS_RETURN_IF_ERROR(turning[0].select(all));
  SPLATLAS_RETURN_IF_ERROR(turning[1].select(nothing));
  for (std::size_t n = 0; n < batch.size(); ++n) {
    SPLATLAS_RETURN_IF_ERROR(turning[n + 2].select(batch[n].selection));
  }
  std::vector<Contender> contenders;
  for (Turning& each : turning) contenders.push_back(each.contender());
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<StageTimes> times,
                            measure_interleaved(contenders, effort.turns()));
  const double empty = ratio(times[1], times[0], effort);
  for (std::size_t n = 0; n < batch.size(); ++n) {
    const double fraction = static_cast<double>(turning[n + 2].visible_voxels()) /
                            static_cast<double>(turning[0].visible_voxels());
    const double over_all = ratio(times[n + 2], times[0], effort);
    const double excess = over_all - 1.15 * fraction - empty;
    table.rows.push_back({{"selection", batch[n].name},
                          {"visible_voxels", turning[n + 2].visible_voxels()},
                          {"visible_fraction", fraction},
                          {"cpu_ms", median(best_of_repeats(times[n + 2][0], effort.frames)).cpu_ms},
                          {"over_all", over_all},
                          {"empty_over_all", empty},
                          {"excess", excess}});
    raise(summary, "skip_excess_max", excess);
  }
  return {};
}

Result<Table> measure_skipping(const std::shared_ptr<const Atlas>& atlas, const Effort& effort,
                               const BenchOptions& options, nlohmann::ordered_json& summary) {
  Table table{
      "skip",
      "Cost against what is selected: volumes of Colin 27, soft, 512x512, normal quality, one thread",
      {"over_all: CPU time over that of the whole head, minimum over repeats of each frame, median over "
       "frames; empty_over_all: the same of nothing",
       "excess: over_all less 1.15 x visible_fraction less empty_over_all; the largest first"}};
  const StructureDraw draw{.mode = DrawMode::kVolume, .opacity = 0.3f, .color = {255, 255, 255}};
  std::vector<NamedSelection> selections;
  const std::vector<NamedSelection> many = many_selections(atlas->graph(), draw, effort.unions);
  for (std::size_t n = 0; n < many.size(); n += effort.every) selections.push_back(many[n]);
  SPLATLAS_ASSIGN_OR_RETURN(const Selection all,
                            Selection::parse(selection_text("Head", kAppearance), atlas->graph()));
  for (std::size_t first = 0; first < selections.size(); first += kAtOnce) {
    const std::size_t count = std::min(kAtOnce, selections.size() - first);
    options.tell(fmt::format("selections {} to {} of {}", first + 1, first + count, selections.size()));
    SPLATLAS_RETURN_IF_ERROR(
        measure_batch(atlas, all, std::span(selections).subspan(first, count), effort, table, summary));
  }
  std::vector<double> empty;
  for (const Row& row : table.rows) empty.push_back(row["empty_over_all"].get<double>());
  summary["empty_over_all"] = median(empty);
  std::stable_sort(table.rows.begin(), table.rows.end(),
                   [](const Row& a, const Row& b) { return a["excess"] > b["excess"]; });
  return table;
}

constexpr std::array kIsolated{"Head",
                               "Brain",
                               "\"Left hemisphere\"",
                               "Cerebellum",
                               "\"Frontal lobe\"",
                               "\"Temporal lobe\"",
                               "Insula",
                               "Hippocampus_L + Amygdala_L",
                               "Precentral_L",
                               "Caudate_R",
                               "Thalamus_L",
                               "Vermis"};

/// An in-memory atlas of the structures of the selection alone.
Result<std::shared_ptr<const Atlas>> isolate(const AtlasContent& content, const Selection& selection,
                                             Selection& isolated_selection) {
  SPLATLAS_ASSIGN_OR_RETURN(const AtlasContent alone, isolated(content, selection, isolated_selection));
  SPLATLAS_ASSIGN_OR_RETURN(std::vector<std::byte> bytes, encode_atlas(alone));
  return Atlas::open_bytes(std::move(bytes), "(isolated)");
}

/// Bytes of the chunks that a first picture reads.
Result<std::uint64_t> chunk_bytes_read(const Atlas& untouched, Turning& turning, const Selection& selection) {
  const std::uint64_t before = untouched.counters().read;
  SPLATLAS_RETURN_IF_ERROR(turning.select(selection));
  return untouched.counters().read - before;
}

Result<Table> measure_isolation(const AtlasContent& content, const Effort& effort,
                                const BenchOptions& options, Report& report) {
  Table table{"isolation",
              "Selections in the full atlas against atlases of those structures alone",
              {"time: CPU time in the full atlas over that in the small one, one thread",
               "bytes: of chunks read from either file for all views, its directory left out"}};
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<std::byte> full_bytes, encode_atlas(content));
  for (std::size_t n = 0; n < kIsolated.size(); n += options.quick ? 4 : 1) {
    options.tell(fmt::format("isolated: {}", kIsolated[n]));
    SPLATLAS_ASSIGN_OR_RETURN(const Selection selection,
                              Selection::parse(selection_text(kIsolated[n], kAppearance), content.graph));
    SPLATLAS_ASSIGN_OR_RETURN(const std::shared_ptr<const Atlas> full, Atlas::open_bytes(full_bytes));
    Selection alone_selection;
    SPLATLAS_ASSIGN_OR_RETURN(const std::shared_ptr<const Atlas> alone,
                              isolate(content, selection, alone_selection));
    std::vector<Turning> turning;
    turning.emplace_back(full, effort);
    turning.emplace_back(alone, effort);
    SPLATLAS_ASSIGN_OR_RETURN(const std::uint64_t full_read, chunk_bytes_read(*full, turning[0], selection));
    SPLATLAS_ASSIGN_OR_RETURN(const std::uint64_t alone_read,
                              chunk_bytes_read(*alone, turning[1], alone_selection));
    const std::vector<Contender> contenders{turning[0].contender(), turning[1].contender()};
    SPLATLAS_ASSIGN_OR_RETURN(const std::vector<StageTimes> times,
                              measure_interleaved(contenders, kIsolationTurns * effort.turns()));
    const double time = ratio(times[0], times[1], effort);
    const double bytes = static_cast<double>(full_read) / static_cast<double>(alone_read);
    const std::uint64_t differ = bits_differ(turning[0].picture().rgba, turning[1].picture().rgba);
    table.rows.push_back({{"selection", kIsolated[n]},
                          {"visible_voxels", turning[0].visible_voxels()},
                          {"cpu_ms", median(best_of_repeats(times[0][0], effort.frames)).cpu_ms},
                          {"alone_cpu_ms", median(best_of_repeats(times[1][0], effort.frames)).cpu_ms},
                          {"time", time},
                          {"bytes_read", full_read},
                          {"alone_bytes_read", alone_read},
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
  const Effort effort = options.quick ? Effort{.frames = 3, .repeats = 2, .unions = 6, .every = 5} : Effort{};
  SPLATLAS_ASSIGN_OR_RETURN(const std::shared_ptr<const Atlas> atlas, open_colin27(options));
  SPLATLAS_ASSIGN_OR_RETURN(report.tables.emplace_back(),
                            measure_skipping(atlas, effort, options, report.summary));
  SPLATLAS_ASSIGN_OR_RETURN(const AtlasContent content, atlas->read_all());
  SPLATLAS_ASSIGN_OR_RETURN(report.tables.emplace_back(),
                            measure_isolation(content, effort, options, report));
  return report;
}

}  // namespace splatlas

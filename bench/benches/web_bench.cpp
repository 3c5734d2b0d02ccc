// Bench `web`: frames by the WebAssembly module in Node beside native ones.
#include <array>
#include <cstdlib>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "bench/bench.h"
#include "bench/measure/frames.h"
#include "bench/measure/measure.h"
#include "bench/scenes/atlases.h"
#include "format/result_macros.h"
#include "player/render/simd/simd_choice.h"
#include "player/renderer.h"
#include "player/web/page_json.h"
#include "tests/support/run_program.h"
#include "tests/support/temporary_folder.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr PictureSize kWebSize{512, 512};
constexpr int kViews = 7;
constexpr std::array kVolumes{BenchScene{"brain", "Brain:volume"},
                              BenchScene{"soft head", "Head:volume(opacity=0.3)"},
                              BenchScene{"left cerebrum", "\"Left cerebrum\":volume"}};
constexpr std::array kSurfaces{BenchScene{"brain", "Brain:surface"}, BenchScene{"head", "Head:surface"},
                               BenchScene{"left cerebrum", "\"Left cerebrum\":surface"}};

/// Frames of one selection, with the key of their ratio in the summary.
struct WebScene {
  const char* kind;
  BenchScene scene;
  NamedQuality quality;
  std::vector<Elapsed> native = {}, web = {};  ///< [view], then the next round
};

std::vector<WebScene> web_scenes() {
  std::vector<WebScene> scenes;
  for (const BenchScene& scene : kVolumes) scenes.push_back({"volume_draft", scene, kQualities[0]});
  for (const BenchScene& scene : kVolumes) scenes.push_back({"volume_normal", scene, kQualities[1]});
  for (const BenchScene& scene : kSurfaces) scenes.push_back({"surface_draft", scene, kQualities[0]});
  return scenes;
}

Result<void> draw_natively(const std::shared_ptr<const Atlas>& atlas, std::vector<WebScene>& scenes) {
  for (WebScene& scene : scenes) {
    Renderer renderer(atlas, {.threads = 1});
    SPLATLAS_ASSIGN_OR_RETURN(const Selection selection,
                              Selection::parse(scene.scene.selection, atlas->graph()));
    SPLATLAS_RETURN_IF_ERROR(renderer.select(selection));
    Frame frame;
    for (int n = 0; n < 2 * kViews; ++n) {  // the first turn builds what later frames share
      Stopwatch watch;
      SPLATLAS_RETURN_IF_ERROR(renderer.render(turned(oblique_camera(), n % kViews, kViews),
                                               {.size = kWebSize, .quality = scene.quality.quality}, frame));
      if (n >= kViews) scene.native.push_back(watch.lap());
    }
  }
  return {};
}

Result<void> draw_by_module(const fs::path& module, const fs::path& atlas, const fs::path& folder,
                            std::vector<WebScene>& scenes) {
  Json frames = Json::array();
  for (const WebScene& scene : scenes) {
    Json states = Json::array();
    for (int n = 0; n < kViews; ++n) {
      states.push_back({{"select", scene.scene.selection},
                        {"quality", scene.quality.name},
                        {"size", {kWebSize.width, kWebSize.height}},
                        {"camera", json_of(turned(oblique_camera(), n, kViews))}});
    }
    frames.push_back(std::move(states));
  }
  std::ofstream(folder / "frames.json") << frames;
  const fs::path script = fs::path(SPLATLAS_SOURCE_DIR) / "bench/peers/web_frames.js";
  const ProgramResult node =
      run_program({"/usr/bin/env", "node", script, module, atlas, folder / "frames.json"});
  if (node.status != 0) return fail(ErrorCode::kFailed, "node {}: {}", script.string(), node.err);
  const Json times = Json::parse(node.out);
  for (std::size_t s = 0; s < scenes.size(); ++s) {
    for (const Json& time : times[s]) scenes[s].web.push_back({time[0], time[1]});
  }
  return {};
}

Table table_of(const std::vector<WebScene>& scenes, Json& summary) {
  Table table{"web",
              fmt::format("Frames by WebAssembly and native ({}), one thread, Colin 27, {}x{}",
                          dispatched_target(), kWebSize.width, kWebSize.height),
              {"medians over views of the best of all rounds; the ratio is that of CPU times"}};
  std::map<std::string, std::vector<double>> ratios;
  for (const WebScene& scene : scenes) {
    const std::vector<Elapsed> native = best_of_repeats(scene.native, kViews);
    const std::vector<Elapsed> web = best_of_repeats(scene.web, kViews);
    const double ratio = median_ratio(web, native).cpu_ms;
    table.rows.push_back({{"frames", scene.kind},
                          {"scene", scene.scene.name},
                          {"web_cpu_ms", median(web).cpu_ms},
                          {"over_native", ratio}});
    ratios[scene.kind].push_back(ratio);
  }
  for (const auto& [kind, of_kind] : ratios)
    summary[fmt::format("web_{}_over_native", kind)] = median(of_kind);
  return table;
}

}  // namespace

Result<Report> run_web_bench(const BenchOptions& options) {
  ::setenv("SPLATLAS_SIMD", "avx2", 0);  // not AVX-512, which older laptops lack
  if (!simd_is_available())
    return fail(ErrorCode::kFailed, "SPLATLAS_SIMD: this machine lacks {}", forced_simd());
  const fs::path module = fs::path(SPLATLAS_SOURCE_DIR) / "build/web/splatlas.wasm";
  if (std::error_code error; !fs::exists(module, error)) {
    return fail(ErrorCode::kFailed, "{} is missing: cmake --preset web && cmake --build --preset web",
                module.string());
  }
  const TemporaryFolder folder;
  fs::path file = options.atlas;
  if (file.empty()) {
    SPLATLAS_ASSIGN_OR_RETURN(const SourceFiles sources, colin27_sources());
    file = folder.path() / "colin27.atlas";
    SPLATLAS_RETURN_IF_ERROR(build_file(sources, file));
  }
  SPLATLAS_ASSIGN_OR_RETURN(const auto atlas, Atlas::open(file));
  std::vector<WebScene> scenes = web_scenes();
  const int rounds = options.quick ? 1 : 3;
  for (int round = 0; round < rounds; ++round) {
    options.tell(fmt::format("round {} of {}", round + 1, rounds));
    SPLATLAS_RETURN_IF_ERROR(draw_natively(atlas, scenes));
    SPLATLAS_RETURN_IF_ERROR(draw_by_module(module, file, folder.path(), scenes));
  }
  Report report;
  report.tables.push_back(table_of(scenes, report.summary));
  return report;
}

}  // namespace splatlas

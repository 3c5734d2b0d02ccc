// splatlas-random-scenes: random scenes against brute force (check_scene.h).
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <exception>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "tests/scenes/check_scene.h"

namespace {

struct Totals {
  std::uint32_t scenes = 0, rays = 0, refused = 0, failed = 0, shows = 0;
  std::uint64_t pixels = 0, compared = 0;
  double largest_from_model = 0, worst_rms = 0;
  std::uint32_t of_largest = 0, of_worst = 0;
};

void run_scene(std::uint32_t seed, std::uint32_t number, Totals& totals) {
  const splatlas::RandomScene scene = splatlas::whole_scene(seed, number);
  const splatlas::SceneReport report = splatlas::check_scene(scene, {.thorough = number % 16 == 0});
  totals.shows += report.shows ? 1 : 0;
  totals.pixels += report.pixels;
  totals.compared += report.compared;
  totals.rays += report.rays ? 1 : 0;
  totals.refused += report.refused ? 1 : 0;
  totals.failed += report.faults.empty() ? 0 : 1;
  if (report.largest_from_model > totals.largest_from_model) {
    totals.largest_from_model = report.largest_from_model;
    totals.of_largest = number;
  }
  if (report.rms_from_truth > totals.worst_rms) {
    totals.worst_rms = report.rms_from_truth;
    totals.of_worst = number;
  }
  for (const std::string& fault : report.faults) {
    fmt::print("--seed {} --first {} --scenes 1: {}\n    {}\n", seed, number, fault, describe(scene));
  }
}

/// Whether enough scenes show anything and enough pixels were compared.
bool is_conclusive(const Totals& totals) {
  constexpr std::uint32_t kSeries = 50;  // shorter series may be empty by chance
  if (totals.scenes < kSeries) return true;
  const bool covered = 2 * totals.shows > totals.scenes && 4 * totals.rays > totals.scenes &&
                       4 * totals.rays < 3 * totals.scenes && 4 * totals.refused < totals.rays;
  return covered && 4 * totals.compared > 3 * totals.pixels;
}

}  // namespace

int main(int argc, char** argv) try {
  CLI::App app("Renders random scenes and compares them with brute force. Exit status 1 when one fails.");
  std::uint32_t seed = 1, scenes = 10000, first = 0;
  app.add_option("--seed", seed, "seed of the series")->capture_default_str();
  app.add_option("--scenes", scenes, "number of scenes")->capture_default_str();
  app.add_option("--first", first, "number of the first scene; seed and number determine a scene")
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  Totals totals;
  totals.scenes = scenes;
  for (std::uint32_t n = 0; n < scenes; ++n) {
    try {
      run_scene(seed, first + n, totals);
    } catch (const std::exception& error) {
      ++totals.failed;
      fmt::print("--seed {} --first {} --scenes 1: {}\n", seed, first + n, error.what());
    }
    std::fflush(stdout);
  }
  fmt::print(
      "{} scenes: {} failed; {} by sheets, {} by rays, of which {} were too wide for surfaces. "
      "{} are not empty.\n"
      "Sheets: maximum error {:.2e} against the discrete model (scene {}).\n"
      "Rays: maximum RMS error {:.3f}/255 against the reference (scene {}); {} of {} pixels compared.\n",
      scenes, totals.failed, scenes - totals.rays, totals.rays, totals.refused, totals.shows,
      totals.largest_from_model, totals.of_largest, totals.worst_rms, totals.of_worst, totals.compared,
      totals.pixels);
  if (!is_conclusive(totals)) {
    fmt::print("Inconclusive: too few scenes show anything, or too few pixels were compared.\n");
    return 1;
  }
  return totals.failed == 0 ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "splatlas-random-scenes: %s\n", error.what());
  return 1;
}

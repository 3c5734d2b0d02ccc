// splatlas-random-scenes: random scenes against brute force (check_scene.h).
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "tests/reference/reference_picture.h"
#include "tests/scenes/check_scene.h"
#include "tests/scenes/ray_truth.h"
#include "tests/support/random_scene.h"
#include "tests/support/render_with.h"

namespace splatlas {
namespace {

struct IdReport {
  std::vector<std::string> faults;  ///< one line each; empty when all checks pass
  std::size_t pixels = 0;           ///< with a structure
  std::size_t mixed = 0;            ///< of them, with two shares of similar size
};

/// Difference of shares below which either structure is right, and of opacities at the threshold of ids.
constexpr double kShareTolerance = 1e-3;
constexpr double kMinOpacity = 1.0 / 255;

class IdChecker {
 public:
  explicit IdChecker(const RandomScene& scene) : scene_(scene), atlas_(open_in_memory(scene.content)) {}

  IdReport run() {
    RenderOptions options = scene_.options;
    options.termination_threshold = 0;
    options.antialiasing = false;
    const auto plain = render(options, 1);
    options.ids = options.depths = true;
    const auto frame = render(options, 1);
    if (!plain || !frame) return report_;
    if (plain->picture.rgba != frame->picture.rgba) fault("ids and depths change the picture");
    if (!plain->ids.empty()) fault("there are ids that nobody asked for");
    for (const unsigned threads : {2u, 8u}) {
      const auto other = render(options, threads);
      if (other && (other->ids.numbers != frame->ids.numbers || other->depths.mm != frame->depths.mm))
        fault(fmt::format("{} threads give other ids or depths", threads));
    }
    check_visible(*frame);
    compare(options);
    return report_;
  }

 private:
  using Shares = std::vector<std::vector<double>>;  // by structure, then pixel

  void fault(std::string text) { report_.faults.push_back(std::move(text)); }
  std::optional<Frame> render(const RenderOptions& options, unsigned threads, bool one_ray = false) {
    Renderer renderer(atlas_, RendererOptions{.threads = threads});
    if (const auto selected = renderer.select(scene_.selection); !selected) {
      fault("select: " + selected.error().message);
      return std::nullopt;
    }
    RenderOverrides overrides = scene_.overrides;
    overrides.one_ray = one_ray;
    auto frame = render_with(renderer, scene_.camera, options, overrides);
    if (frame) return *std::move(frame);
    if (frame.error().message.find("too wide for surfaces") == std::string::npos)
      fault("render: " + frame.error().message);
    return std::nullopt;
  }

  /// Only visible pixels have a number and a depth.
  void check_visible(const Frame& frame) {
    for (std::size_t n = 0; n < frame.ids.numbers.size(); ++n) {
      const float opacity = frame.picture.rgba[4 * n + 3];
      const bool shows = frame.ids.numbers[n] != 0 || frame.depths.mm[n] != DepthMap::kBackground;
      if (shows && opacity < static_cast<float>(kMinOpacity))
        return fault(fmt::format("pixel {} of opacity {} has number {} and depth {}", n, opacity,
                                 frame.ids.numbers[n], frame.depths.mm[n]));
    }
  }

  /// Compares ids at high quality with the shares along the rays of pixel centres.
  void compare(RenderOptions options) {
    options.quality = Quality::kHigh;
    const auto frame = render(options, 1, true);
    if (!frame) return;
    Shares shares(scene_.selection.structures.size());
    std::vector<bool> is_known(frame->ids.numbers.size(), true);
    for (StructureIndex first = 0; first < shares.size(); first += 3) {
      const RayTruth truth(scene_, false, reference::ShareChannels{first, first + 1, first + 2});
      for (std::size_t n = 0; n < is_known.size(); ++n) {
        const auto width = static_cast<std::size_t>(options.size.width);
        const auto pixel = truth.at(static_cast<int>(n % width), static_cast<int>(n / width));
        if (!pixel) is_known[n] = false;
        for (std::size_t c = 0; c < 3 && first + c < shares.size(); ++c)
          shares[first + c].push_back(pixel ? (*pixel)[c] : 0);
      }
    }
    for (std::size_t n = 0; n < is_known.size(); ++n) {
      const StructureNumber number = frame->ids.numbers[n];
      if (!is_known[n] || number == 0) continue;
      ++report_.pixels;
      report_.mixed += is_mixed(shares, n) ? 1 : 0;
      double largest = 0;
      for (const auto& of_structure : shares) largest = std::max(largest, of_structure[n]);
      const double lacks = largest - shares[number - 1u][n];
      if (lacks > kShareTolerance)
        return fault(
            fmt::format("pixel {}: structure {} has a share {} below the largest", n, number - 1, lacks));
    }
  }

  /// True if the second largest share is at least a quarter of the largest.
  static bool is_mixed(const Shares& shares, std::size_t pixel) {
    double largest = 0, second = 0;
    for (const auto& of_structure : shares) {
      second = std::max(second, std::min(largest, of_structure[pixel]));
      largest = std::max(largest, of_structure[pixel]);
    }
    return 4 * second >= largest;
  }

  const RandomScene& scene_;
  std::shared_ptr<const Atlas> atlas_;
  IdReport report_;
};

/// Renders the scene with ids and depths, several times, and compares:
///   - pictures with and without them: equal bits;
///   - ids and depths of 1, 2 and 8 threads: equal;
///   - pixels below the threshold of opacity: no number and no depth;
///   - at high quality, one ray a pixel: each pixel's share on the exact ray is the largest, to 1e-3.
IdReport check_ids(const RandomScene& scene) {
  return IdChecker(scene).run();
}

/// A scene, and the checks that it gets.
struct CheckedScene {
  RandomScene scene;
  SceneChecks checks;
};

/// Rays through a volume without surfaces, in pairs of post- and pre-classification. The eye may lie inside.
CheckedScene volume_scene(std::uint32_t pair, bool after) {
  RandomScene scene = after ? random_scene(pair, 9) : random_scene(pair);
  for (StructureDraw& draw : scene.selection.structures) {
    if (draw.mode != DrawMode::kOff) draw.mode = DrawMode::kVolume;
  }
  if (after) {
    scene.options.size.width = std::min(scene.options.size.width, 14);
    scene.options.size.height = std::min(scene.options.size.height, 14);
    scene.options.hybrid_shading = false;
    scene.options.classification = Classification::kAfter;
  }
  if (!after || pair % 3 != 0) {
    scene.camera.projection = CameraProjection::kPerspective;
    scene.camera.field_of_view_deg = std::array{0.01, 30.0, 75.0, 120.0, after ? 170.0 : 179.0}[pair % 5];
  }
  return {std::move(scene), {.thorough = true, .max_visible_rms = after ? 0.5 : 1.0}};
}

CheckedScene make_scene(const std::string& kind, std::uint32_t seed, std::uint32_t number) {
  if (kind == "sheets") return {random_scene(number), {.thorough = number % 5 == 0}};
  if (kind == "volumes") return volume_scene(number / 2, number % 2 == 0);
  if (kind == "cuts") return {cut_scene(seed, number), {.thorough = true, .max_rms = 0.5}};
  return {whole_scene(seed, number), {.thorough = number % 16 == 0}};
}

/// Scenes of all kinds, in turn.
RandomScene id_scene(std::uint32_t seed, std::uint32_t number) {
  switch (number % 4) {
    case 0: return random_scene(number);
    case 1: return cut_scene(seed, number);
    case 2: return volume_scene(number, number % 8 == 2).scene;
    default: break;
  }
  return whole_scene(seed, number);
}

/// Checks the id images of scenes.
int check_id_scenes(std::uint32_t seed, std::uint32_t first, std::uint32_t scenes) {
  std::size_t failed = 0, pixels = 0, mixed = 0;
  for (std::uint32_t n = first; n < first + scenes; ++n) {
    const RandomScene scene = id_scene(seed, n);
    const IdReport report = check_ids(scene);
    failed += report.faults.empty() ? 0 : 1;
    pixels += report.pixels;
    mixed += report.mixed;
    for (const std::string& fault : report.faults)
      fmt::print("--kind ids --seed {} --first {} --scenes 1: {}\n    {}\n", seed, n, fault, describe(scene));
    std::fflush(stdout);
  }
  fmt::print("{} scenes: {} failed. {} pixels with a structure, {} of them with two similar shares.\n",
             scenes, failed, pixels, mixed);
  constexpr std::uint32_t kSeries = 200;  // shorter series may have few mixed pixels by chance
  return failed == 0 && (scenes < kSeries || mixed > std::size_t{7} * scenes) ? 0 : 1;
}

/// Number of scenes with a property.
template <typename Property>
std::size_t count(const std::vector<SceneReport>& reports, const Property& property) {
  return static_cast<std::size_t>(std::ranges::count_if(reports, property));
}

std::size_t sum(const std::vector<SceneReport>& reports, std::size_t SceneReport::*number) {
  std::size_t total = 0;
  for (const SceneReport& report : reports) total += report.*number;
  return total;
}

/// True if enough pictures of both renderers are not empty, and enough pixels were compared.
bool is_conclusive(const std::string& kind, const std::vector<SceneReport>& reports) {
  constexpr std::size_t kSeries = 50;  // shorter series may be empty by chance
  const std::size_t scenes = reports.size();
  if (scenes < kSeries || kind == "volumes") return true;
  if (kind == "sheets") return sum(reports, &SceneReport::antialiased) > scenes;
  if (kind == "cuts") {  // planes remove most of some scenes
    return 5 * count(reports, &SceneReport::shows) > 2 * scenes &&
           4 * sum(reports, &SceneReport::compared) > 3 * sum(reports, &SceneReport::pixels);
  }
  const std::size_t rays = count(reports, &SceneReport::rays),
                    refused = count(reports, &SceneReport::refused);
  return 2 * count(reports, &SceneReport::shows) > scenes && 4 * rays > scenes && 4 * rays < 3 * scenes &&
         8 * count(reports, &SceneReport::adaptive) > scenes && 8 * refused < scenes && 4 * refused < rays &&
         4 * sum(reports, &SceneReport::compared) > 3 * sum(reports, &SceneReport::pixels);
}

}  // namespace

int check_scenes(int argc, char** argv) {
  CLI::App app("Renders random scenes and compares them with brute force. Exit status 1 when one fails.");
  std::string kind = "whole";
  std::uint32_t seed = 1, scenes = 10000, first = 0;
  app.add_option("--kind", kind, "kind of scenes")
      ->check(CLI::IsMember({"whole", "sheets", "volumes", "cuts", "ids"}))
      ->capture_default_str();
  app.add_option("--seed", seed, "seed of whole and cut scenes")->capture_default_str();
  app.add_option("--scenes", scenes, "number of scenes")->capture_default_str();
  app.add_option("--first", first, "number of the first scene; kind, seed and number determine a scene")
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  if (kind == "ids") return check_id_scenes(seed, first, scenes);
  std::vector<SceneReport> reports(scenes);
  for (std::uint32_t n = 0; n < scenes; ++n) {
    const auto print = [&](const std::string& text) {
      fmt::print("--kind {} --seed {} --first {} --scenes 1: {}\n", kind, seed, first + n, text);
    };
    try {
      const auto [scene, checks] = make_scene(kind, seed, first + n);
      reports[n] = check_scene(scene, checks);
      for (const std::string& fault : reports[n].faults) print(fault + "\n    " + describe(scene));
    } catch (const std::exception& error) {
      reports[n].faults = {error.what()};
      print(error.what());
    }
    std::fflush(stdout);
  }
  const std::size_t failed = count(reports, [](const SceneReport& r) { return !r.faults.empty(); });
  const std::size_t rays = count(reports, &SceneReport::rays);
  const auto worst_model = std::ranges::max_element(reports, {}, &SceneReport::largest_from_model);
  const auto worst_rays = std::ranges::max_element(reports, {}, &SceneReport::rms_from_truth);
  fmt::print(
      "{} scenes: {} failed; {} by sheets, {} by rays, of which {} were too wide for surfaces. "
      "{} are not empty.\n",
      scenes, failed, scenes - rays, rays, count(reports, &SceneReport::refused),
      count(reports, &SceneReport::shows));
  if (scenes == 0) return 0;
  fmt::print(
      "Sheets: maximum error {:.2e} against the discrete model (scene {}).\n"
      "Rays: maximum RMS error {:.3f}/255 against the reference (scene {}); {} of {} pixels compared.\n",
      worst_model->largest_from_model, first + (worst_model - reports.begin()), worst_rays->rms_from_truth,
      first + (worst_rays - reports.begin()), sum(reports, &SceneReport::compared),
      sum(reports, &SceneReport::pixels));
  if (!is_conclusive(kind, reports)) {
    fmt::print("Inconclusive: too few scenes show anything, or too few pixels were compared.\n");
    return 1;
  }
  return failed == 0 ? 0 : 1;
}

}  // namespace splatlas

int main(int argc, char** argv) try {
  return splatlas::check_scenes(argc, argv);
} catch (const std::exception& error) {
  std::fprintf(stderr, "splatlas-random-scenes: %s\n", error.what());
  return 1;
}

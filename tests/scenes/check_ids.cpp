#include "tests/scenes/check_ids.h"

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "tests/reference/reference_picture.h"
#include "tests/scenes/ray_truth.h"
#include "tests/support/render_with.h"

namespace splatlas {
namespace {

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

}  // namespace

IdReport check_ids(const RandomScene& scene) {
  return IdChecker(scene).run();
}

}  // namespace splatlas

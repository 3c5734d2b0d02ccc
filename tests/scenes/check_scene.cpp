#include "tests/scenes/check_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "player/frame/render_overrides.h"
#include "player/view/shear.h"
#include "tests/reference/picture_difference.h"
#include "tests/scenes/expected_counts.h"
#include "tests/scenes/ray_truth.h"
#include "tests/support/render.h"

namespace splatlas {
namespace {

constexpr double kRounding = 2e-5;

class Checker {
 public:
  Checker(const RandomScene& scene, const SceneChecks& checks)
      : scene_(scene), checks_(checks), atlas_(open_in_memory(scene.content)) {
    report_.rays = scene.options.classification == Classification::kAfter ||
                   scene.camera.projection == CameraProjection::kPerspective;
  }

  SceneReport run() {
    const auto picture = render(scene_.options, 1);
    if (!picture) return report_;
    for (std::size_t n = 3; n < picture->rgba.size(); n += 4)
      report_.shows = report_.shows || picture->rgba[n] > 0;
    check_counts();
    check_range(*picture);
    for (const unsigned threads : {2u, 8u}) {
      const auto other = render(scene_.options, threads);
      if (other && other->rgba != picture->rgba) fault(fmt::format("{} threads give other bits", threads));
    }
    RenderOptions options = scene_.options;
    options.antialiasing = false;
    const auto ended = render(options, 1);
    options.termination_threshold = 0;
    const auto all = render(options, 1);
    if (!ended || !all) return report_;
    check_range(*all);
    check_termination(*ended, *all);
    check_depth_cue(options, *all);
    report_.rays ? check_rays(options) : check_sheets(options, *all);
    return report_;
  }

 private:
  void fault(std::string text) { report_.faults.push_back(std::move(text)); }

  std::optional<Picture> render(const RenderOptions& options, unsigned threads) {
    Renderer renderer(atlas_, {threads, 0});
    if (const auto selected = renderer.select(scene_.selection); !selected) {
      fault("select: " + selected.error().message);
      return std::nullopt;
    }
    auto picture = render_with(renderer, scene_.camera, options, scene_.overrides);
    stats_ = renderer.stats();
    if (picture) return *std::move(picture);
    report_.refused = picture.error().code == ErrorCode::kUsage &&
                      picture.error().message.find("too wide for surfaces") != std::string::npos;
    if (!report_.refused) fault("render: " + picture.error().message);
    return std::nullopt;
  }

  void check_counts() {
    const View view = *view_of(scene_.camera, scene_.options.size, scene_.content.display);
    const Axis axis = report_.rays ? Axis::kZ : factorise(view.plane, storage_grid(scene_.content)).principal;
    const ExpectedCounts expected = expected_counts(scene_.content, scene_.selection, axis);
    const auto compare = [&](const char* what, std::uint64_t is, std::uint64_t should) {
      if (is != should) fault(fmt::format("{}: {}, not {}", what, is, should));
    };
    compare("volume voxels", stats_.volume_voxels, expected.volume);
    compare("surface voxels", stats_.surface_voxels, expected.surface);
    compare("hybrid voxels", stats_.hybrid_voxels, expected.hybrid);
    compare("runs", stats_.runs_visited, expected.runs);
    compare("triangles", stats_.triangles, expected.triangles);
    if (stats_.voxels_visited > expected.volume + expected.hybrid) {
      fault(fmt::format("{} voxels visited", stats_.voxels_visited));
    }
  }

  void check_range(const Picture& picture) {
    const double violation = reference::energy_violation(picture);
    if (!(violation <= (report_.rays ? 1e-5 : 1e-6))) {
      fault(fmt::format("0 <= colour <= alpha <= 1 is violated by {}", violation));
    }
  }

  void check_termination(const Picture& ended, const Picture& all) {
    // A value may also grow: what a skipped block would have absorbed stays visible behind it.
    const double threshold = static_cast<double>(termination_threshold(scene_.options));
    for (std::size_t n = 0; n < all.rgba.size(); ++n) {
      const double loss = static_cast<double>(all.rgba[n]) - static_cast<double>(ended.rgba[n]);
      if (loss >= -threshold - 1e-6 && loss <= threshold + 1e-6) continue;
      fault(fmt::format("early ray termination takes {} from value {}", loss, n));
      return;
    }
  }

  void check_depth_cue(RenderOptions options, const Picture& all) {
    options.depth_cue = DepthCue::kEdges;
    const auto one = render(options, 1), two = render(options, 2);
    if (!one || !two) return;
    if (one->rgba != two->rgba) fault("2 threads give other bits with a depth cue");
    for (std::size_t n = 0; n < all.rgba.size(); ++n) {
      const float min = n % 4 == 3 ? all.rgba[n] : (1 - options.depth_cue_strength) * all.rgba[n] - 1e-6f;
      if (one->rgba[n] >= min && one->rgba[n] <= all.rgba[n]) continue;
      fault(fmt::format("the depth cue changes value {} from {} to {}", n, all.rgba[n], one->rgba[n]));
      return;
    }
  }

  void check_sheets(const RenderOptions& options, const Picture& all) {
    const reference::ReferenceScene of_reference{scene_.content, scene_.selection, scene_.camera, options};
    const auto centers = reference::render_model(of_reference);
    const auto d = reference::difference(all, centers);
    report_.largest_from_model = d.largest;
    if (!(d.largest <= kRounding)) fault("sheets differ from the model: " + to_text(d));
    if (!checks_.thorough) return;
    RenderOptions antialiased = options;
    antialiased.antialiasing = true;
    const auto picture = render(antialiased, 1);
    if (!picture) return;
    check_range(*picture);
    const std::size_t samples = options.quality == Quality::kDraft    ? 1
                                : options.quality == Quality::kNormal ? 4
                                                                      : 8;
    const auto means = reference::render_model(of_reference, sample_pattern(samples));
    for (std::size_t p = 0; p < centers.pixels.size(); ++p) {
      const auto pixel = std::span(picture->rgba).subspan(4 * p, 4);
      if (distance(pixel, centers.pixels[p]) <= kRounding) continue;
      ++report_.antialiased;
      const double error = distance(pixel, means.pixels[p]);
      if (error <= kRounding) continue;
      fault(fmt::format("antialiased pixel {} differs from the mean of its samples by {}", p, error));
      return;
    }
  }

  static double distance(std::span<const float> pixel, const std::array<double, 4>& expected) {
    double max = 0;
    for (std::size_t c = 0; c < 4; ++c) {
      max = std::max(max, std::abs(static_cast<double>(pixel[c]) - expected[c]));
    }
    return max;
  }

  /// Whether post-classified grey values reach far beyond the transfer functions, which are at most 200 wide.
  /// A transfer function then spans a vanishing part of a cell, along a curved isosurface.
  [[nodiscard]] bool has_step_transfer() const {
    const VoxelBuffer& values = scene_.content.values;
    if (scene_.options.classification == Classification::kBefore || values.empty()) return false;
    return visit_voxel_type(values.type, [&](auto tag) {
      using T = decltype(tag);
      const T* typed = values.as<T>();
      return std::any_of(typed, typed + scene_.content.class_volume.size(), [](T value) {
        return std::isfinite(static_cast<double>(value)) && std::abs(static_cast<double>(value)) > 1e4;
      });
    });
  }

  void check_rays(RenderOptions options) {
    options.quality = Quality::kHigh;
    const auto picture = render(options, 1);
    if (!picture) return;
    options.antialiasing = true;
    const auto antialiased = render(options, 1);
    if (stats_.triangles == 0 && antialiased && antialiased->rgba != picture->rgba) {
      fault("antialiasing changes a volume");
    }
    const RayTruth truth(scene_, options.hybrid_shading);
    std::size_t visible = 0;
    std::vector<std::pair<double, std::size_t>> squares;  // squared error of a pixel, its number
    const auto width = static_cast<std::size_t>(picture->size.width);
    for (std::size_t n = 0; n < picture->rgba.size() / 4; n += checks_.thorough ? 1 : 5) {
      const auto expected = truth.at(static_cast<int>(n % width), static_cast<int>(n / width));
      ++report_.pixels;
      if (!expected) continue;
      ++report_.compared;
      visible += picture->rgba[4 * n + 3] > 0 || (*expected)[3] > 0 ? 1 : 0;
      double square = 0;
      for (std::size_t c = 0; c < 4; ++c) {
        square += std::pow(static_cast<double>(picture->rgba[4 * n + c]) - (*expected)[c], 2);
      }
      squares.emplace_back(square, n);
    }
    // A grazing ray may miss an opaque step between two samples.
    const bool steps = has_step_transfer();
    std::sort(squares.begin(), squares.end());
    if (steps && !squares.empty()) squares.resize(squares.size() - 1 - squares.size() / 50);
    if (squares.empty()) return;
    const double sum = std::accumulate(squares.begin(), squares.end(), 0.0,
                                       [](double so_far, const auto& one) { return so_far + one.first; });
    report_.rms_from_truth = 255 * std::sqrt(sum / (4 * static_cast<double>(squares.size())));
    const double visible_rms = visible == 0 ? 0 : 255 * std::sqrt(sum / (4 * static_cast<double>(visible)));
    if (report_.rms_from_truth <= (steps ? 4 : 1) && visible_rms <= checks_.max_visible_rms) return;
    const auto [worst, pixel] = squares.back();
    fault(fmt::format("RMS error of rays {:.3f}/255; {:.3f}/255 at pixel {}, {}", report_.rms_from_truth,
                      255 * std::sqrt(worst), pixel % width, pixel / width));
  }

  const RandomScene& scene_;
  SceneChecks checks_;
  std::shared_ptr<const Atlas> atlas_;
  RenderStats stats_;
  SceneReport report_;
};

}  // namespace

SceneReport check_scene(const RandomScene& scene, const SceneChecks& checks) {
  return Checker(scene, checks).run();
}

}  // namespace splatlas

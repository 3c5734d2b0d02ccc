#include "tests/scenes/check_scene.h"

#include <algorithm>
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
  Checker(const RandomScene& scene, bool thorough)
      : scene_(scene), thorough_(thorough), atlas_(open_in_memory(scene.content)) {
    report_.rays = scene.options.classification == Classification::kAfter ||
                   scene.camera.projection == CameraProjection::kPerspective;
  }

  SceneReport run() {
    const auto picture = render(scene_.options, 1);
    if (!picture) return report_;
    for (std::size_t n = 3; n < picture->rgba.size(); n += 4)
      report_.shows = report_.shows || picture->rgba[n] > 0;
    check_counts();
    check_invariants(*picture);
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

  void check_invariants(const Picture& picture) {
    const double violation = reference::energy_violation(picture);
    if (!(violation <= (report_.rays ? 1e-5 : 1e-6))) {
      fault(fmt::format("0 <= colour <= alpha <= 1 is missed by {}", violation));
    }
  }

  void check_termination(const Picture& ended, const Picture& all) {
    const double floor = static_cast<double>(termination_threshold(scene_.options));
    // Behind surfaces that let through no more than the floor, volumes are seen without the surfaces in them.
    const double more = stats_.triangles > 0 ? floor : 0;
    for (std::size_t n = 0; n < all.rgba.size(); ++n) {
      const double left_out = static_cast<double>(all.rgba[n]) - static_cast<double>(ended.rgba[n]);
      if (left_out >= -more - 1e-6 && left_out <= floor + 1e-6) continue;
      fault(fmt::format("early termination leaves out {} of value {}", left_out, n));
      return;
    }
  }

  void check_depth_cue(RenderOptions options, const Picture& all) {
    options.depth_cue = DepthCue::kEdges;
    const auto one = render(options, 1), two = render(options, 2);
    if (!one || !two) return;
    if (one->rgba != two->rgba) fault("2 threads give other bits with a depth cue");
    for (std::size_t n = 0; n < all.rgba.size(); ++n) {
      const float darkest = n % 4 == 3 ? all.rgba[n] : (1 - options.depth_cue_strength) * all.rgba[n] - 1e-6f;
      if (one->rgba[n] >= darkest && one->rgba[n] <= all.rgba[n]) continue;
      fault(fmt::format("a depth cue makes value {} {}, from {}", n, one->rgba[n], all.rgba[n]));
      return;
    }
  }

  void check_sheets(const RenderOptions& options, const Picture& all) {
    const reference::ReferenceScene of_reference{scene_.content, scene_.selection, scene_.camera, options};
    const auto centers = reference::render_model(of_reference);
    const auto d = reference::difference(all, centers);
    report_.largest_from_model = d.largest;
    if (!(d.largest <= kRounding)) fault("sheets differ from the model: " + to_text(d));
    if (!thorough_) return;
    RenderOptions antialiased = options;
    antialiased.antialiasing = true;
    const auto picture = render(antialiased, 1);
    if (!picture) return;
    const std::size_t samples = options.quality == Quality::kDraft    ? 1
                                : options.quality == Quality::kNormal ? 4
                                                                      : 8;
    const auto means = reference::render_model(of_reference, sample_pattern(samples));
    for (std::size_t p = 0; p < centers.pixels.size(); ++p) {
      const auto pixel = std::span(picture->rgba).subspan(4 * p, 4);
      const double apart = std::min(distance(pixel, centers.pixels[p]), distance(pixel, means.pixels[p]));
      if (apart <= kRounding) continue;
      fault(fmt::format("pixel {} is {} from one sample, and from the mean of all", p, apart));
      return;
    }
  }

  static double distance(std::span<const float> pixel, const std::array<double, 4>& expected) {
    double most = 0;
    for (std::size_t c = 0; c < 4; ++c) {
      most = std::max(most, std::abs(static_cast<double>(pixel[c]) - expected[c]));
    }
    return most;
  }

  /// Grey values beyond all measure (transfer functions are at most 200 wide), classified after
  /// interpolation: a whole transfer function lies in a vanishing part of the way from one voxel to the next,
  /// on surfaces as bent as their cell.
  [[nodiscard]] bool ramps_are_steps() const {
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
    const RayTruth truth(scene_, options.hybrid_shading);
    std::vector<std::pair<double, std::size_t>> squares;  // of a pixel's difference, and its number
    const auto width = static_cast<std::size_t>(picture->size.width);
    for (std::size_t n = 0; n < picture->rgba.size() / 4; n += thorough_ ? 1 : 5) {
      const auto expected = truth.at(static_cast<int>(n % width), static_cast<int>(n / width));
      ++report_.pixels;
      if (!expected) continue;  // rounding decides what is seen
      ++report_.compared;
      double square = 0;
      for (std::size_t c = 0; c < 4; ++c) {
        square += std::pow(static_cast<double>(picture->rgba[4 * n + c]) - (*expected)[c], 2);
      }
      squares.emplace_back(square, n);
    }
    // What is opaque at once may lie between two samples of a ray that only just meets it.
    const bool steps = ramps_are_steps();
    std::sort(squares.begin(), squares.end());
    if (steps && !squares.empty()) squares.resize(squares.size() - 1 - squares.size() / 50);
    if (squares.empty()) return;
    const double sum = std::accumulate(squares.begin(), squares.end(), 0.0,
                                       [](double so_far, const auto& one) { return so_far + one.first; });
    report_.rms_from_truth = 255 * std::sqrt(sum / (4 * static_cast<double>(squares.size())));
    if (report_.rms_from_truth <= (steps ? 4 : 1)) return;
    const auto [worst, pixel] = squares.back();
    fault(fmt::format("rays are {:.3f}/255 from the truth; {:.3f} at pixel {}, {}", report_.rms_from_truth,
                      255 * std::sqrt(worst), pixel % width, pixel / width));
  }

  const RandomScene& scene_;
  bool thorough_;
  std::shared_ptr<const Atlas> atlas_;
  RenderStats stats_;
  SceneReport report_;
};

}  // namespace

SceneReport check_scene(const RandomScene& scene, bool thorough) {
  return Checker(scene, thorough).run();
}

}  // namespace splatlas

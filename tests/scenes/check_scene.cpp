#include "tests/scenes/check_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "player/render/view/shear.h"
#include "tests/reference/picture_difference.h"
#include "tests/scenes/ray_truth.h"
#include "tests/support/kernel_targets.h"
#include "tests/support/render_with.h"

namespace splatlas {
namespace {

constexpr double kRounding = 2e-5;

/// The rules of VoxelRole, restated.
struct Drawn {
  bool volume = false, surface = false;

  Drawn(const ClassTable& classes, ClassId c, const Selection& selection) {
    for (const Membership& member : classes.members(c)) {
      const DrawMode mode = selection.structures[member.structure].mode;
      if (mode == DrawMode::kOff) continue;
      volume |= member.part != Part::kCrossed && mode != DrawMode::kSurface;
      surface |=
          member.part == Part::kCrossed || (member.part == Part::kBoundary && mode != DrawMode::kVolume);
    }
  }
};

/// Brute-force counts of a frame.
struct ExpectedCounts {
  std::uint64_t volume = 0, surface = 0, hybrid = 0;  ///< voxels (paper, table 2)
  std::uint64_t runs = 0;       ///< of classes drawn as volume, along scanlines of the principal axis
  std::uint64_t triangles = 0;  ///< of the selected surfaces

  ExpectedCounts(const AtlasContent& content, const Selection& selection, Axis principal) {
    std::vector<Drawn> of_class;
    for (ClassId c = 0; c < content.classes.size(); ++c) of_class.emplace_back(content.classes, c, selection);
    const Grid grid = storage_grid(content);
    const ScanOrder order = ScanOrder::of(principal);
    Index3 at{};
    std::int64_t &slice = at[order.slice_axis], &row = at[order.row_axis], &scan = at[order.scan_axis];
    for (slice = 0; slice < grid.size[order.slice_axis]; ++slice) {
      for (row = 0; row < grid.size[order.row_axis]; ++row) {
        ClassId before = kEmptyClass;
        for (scan = 0; scan < grid.size[order.scan_axis]; ++scan) {
          const ClassId c = content.class_volume[static_cast<std::size_t>(grid.offset(at[0], at[1], at[2]))];
          const Drawn& role = of_class[c];
          volume += role.volume && !role.surface ? 1 : 0;
          surface += role.surface && !role.volume ? 1 : 0;
          hybrid += role.surface && role.volume ? 1 : 0;
          runs += role.volume && c != before ? 1 : 0;
          before = c;
        }
      }
    }
    for (StructureIndex s = 0; s < content.graph.size(); ++s) {
      const DrawMode mode = selection.structures[s].mode;
      const bool shown = content.graph[s].external ? mode != DrawMode::kOff
                                                   : mode == DrawMode::kSurface || mode == DrawMode::kBoth;
      if (shown) triangles += content.surfaces[s].triangles.size();
    }
  }
};

class Checker {
 public:
  Checker(const RandomScene& scene, const SceneChecks& checks)
      : scene_(scene),
        checks_(checks),
        atlas_(open_in_memory(scene.content)),
        alone_(atlas_, {.threads = 1}) {}

  SceneReport run() {
    if (!select(alone_)) return report_;
    check_kernels();
    const auto picture = render(scene_.options, 1);
    if (!picture) return report_;
    report_.rays = stats_.rays;
    report_.adaptive = report_.rays && scene_.options.quality != Quality::kDraft;
    for (std::size_t n = 3; n < picture->rgba.size(); n += 4)
      report_.shows = report_.shows || picture->rgba[n] > 0;
    check_counts();
    if (!report_.rays && checks_.thorough) check_visits();
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

  bool select(Renderer& renderer) {
    const auto selected = renderer.select(scene_.selection);
    if (!selected) fault("select: " + selected.error().message);
    return selected.has_value();
  }

  std::optional<Picture> render(const RenderOptions& options, unsigned threads) {
    return render(options, threads, scene_.overrides);
  }
  std::optional<Picture> render(const RenderOptions& options, unsigned threads,
                                const RenderOverrides& overrides) {
    std::optional<Renderer> several;
    if (threads > 1 && !select(several.emplace(atlas_, RendererOptions{.threads = threads})))
      return std::nullopt;
    Renderer& renderer = several ? *several : alone_;
    auto frame = render_with(renderer, scene_.camera, options, overrides);
    if (frame) {
      stats_ = frame->stats;
      return std::move(frame->picture);
    }
    report_.refused = frame.error().code == ErrorCode::kUsage &&
                      frame.error().message.find("too wide for surfaces") != std::string::npos;
    if (!report_.refused) fault("render: " + frame.error().message);
    return std::nullopt;
  }

  void check_kernels() {
    RenderOptions options = scene_.options;
    options.termination_threshold = 0;
    const auto scalar = render(options, 1, {.simd = false});
    for (const std::int64_t target : kernel_targets()) {
      const DispatchTo only(target);
      const auto picture = render(options, 1, {});
      if (picture.has_value() != scalar.has_value()) {
        fault(fmt::format("only one of {} and the scalar reference draws", hwy::TargetName(target)));
      } else if (picture) {
        const double largest = reference::difference(*picture, *scalar).largest;
        if (largest <= kRounding) continue;
        fault(fmt::format("{} differs from the scalar reference by {}", hwy::TargetName(target), largest));
      }
    }
  }

  void check_counts() {
    const View view = *view_of(scene_.camera, scene_.options.size, scene_.content.display);
    const Axis axis = report_.rays ? Axis::kZ : factorise(view.plane, storage_grid(scene_.content)).principal;
    const ExpectedCounts expected(scene_.content, scene_.selection, axis);
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

  /// With everything in view, along every axis: exactly the visible voxels and their runs.
  void check_visits() {
    Camera camera = scene_.camera;
    camera.zoom = 0.8;
    camera.center_lps_mm.reset();
    RenderOptions options = scene_.options;
    options.size = {64, 64};
    options.cuts = {};
    if (options.quality == Quality::kHigh) options.quality = Quality::kNormal;  // by sheets
    const ParallelView view = *parallel_view(camera, options.size, scene_.content.display);
    const auto voxels = reference::optical_field(scene_.content, scene_.selection, view, false).voxels;
    const auto visible = std::count_if(voxels.begin(), voxels.end(),
                                       [](const reference::VoxelOptics& v) { return v.extinction > 0; });
    for (const Axis axis : kAxes) {
      const RenderOverrides overrides{.simd = scene_.overrides.simd, .principal_axis = axis};
      const auto frame = render_with(alone_, camera, options, overrides);
      if (!frame) continue;  // perpendicular to this axis
      const RenderStats& stats = frame->stats;
      const ExpectedCounts expected(scene_.content, scene_.selection, axis);
      if (stats.voxels_visited != static_cast<std::uint64_t>(visible) ||
          stats.runs_visited != expected.runs || stats.triangles != expected.triangles) {
        fault(fmt::format("axis {}: visits {} voxels, {} runs, {} triangles, not {}, {}, {}",
                          static_cast<int>(axis), stats.voxels_visited, stats.runs_visited, stats.triangles,
                          visible, expected.runs, expected.triangles));
      }
    }
  }

  void check_range(const Picture& picture) {
    const double violation = reference::energy_violation(picture);
    if (!(violation <= (report_.rays ? 1e-5 : 1e-6))) {
      fault(fmt::format("0 <= colour <= alpha <= 1 is violated by {}", violation));
    }
  }

  void check_termination(const Picture& ended, const Picture& all) {
    // A value may also grow: radiance from behind a skipped block is not absorbed.
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

  /// True if post-classified grey values reach far beyond the transfer functions, which are at most 200 wide.
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
    RenderOverrides overrides = scene_.overrides;
    overrides.one_ray = true;
    const auto picture = render(options, 1, overrides);
    if (!picture) return;
    check_range(*picture);
    options.antialiasing = true;
    const auto antialiased = render(options, 1, overrides);
    if (stats_.triangles == 0 && options.cuts.empty() && antialiased && antialiased->rgba != picture->rgba) {
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
    if (report_.rms_from_truth <= (steps ? 4 : checks_.max_rms) && visible_rms <= checks_.max_visible_rms)
      return;
    const auto [worst, pixel] = squares.back();
    fault(fmt::format("RMS error of rays {:.3f}/255; {:.3f}/255 at pixel {}, {}", report_.rms_from_truth,
                      255 * std::sqrt(worst), pixel % width, pixel / width));
  }

  const RandomScene& scene_;
  SceneChecks checks_;
  std::shared_ptr<const Atlas> atlas_;
  Renderer alone_;  // with one thread
  RenderStats stats_;
  SceneReport report_;
};

}  // namespace

SceneReport check_scene(const RandomScene& scene, const SceneChecks& checks) {
  return Checker(scene, checks).run();
}

}  // namespace splatlas

#include "tests/support/random_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <random>

#include <fmt/format.h>

namespace splatlas {
namespace {

/// Makes one scene. Own arithmetic on the generator's bits: the standard library's distributions differ
/// between implementations.
class SceneMaker {
 public:
  SceneMaker(std::uint32_t number, std::int64_t max_side) : random_(number), max_side_(max_side) {}

  RandomScene make() {
    TestVolume volume;
    volume.grid = make_grid();
    const std::size_t structures = 1 + below(4);
    for (std::size_t s = 0; s < structures; ++s) {
      TestStructure structure{fmt::format("s{}", s), make_structure_mask(volume.grid.size)};
      structure.color = make_color();
      if (s > 0 && below(3) == 0) structure.parents = {static_cast<StructureIndex>(below(s))};
      volume.structures.push_back(std::move(structure));
    }
    volume.values = make_grey_values(volume.grid.voxels());
    volume.window_low = real(-20, 60);
    volume.window_high = below(10) == 0 ? volume.window_low : volume.window_low + real(10, 200);
    RandomScene scene{make_content(volume), make_selection(structures), {}, {}};
    make_view(scene);
    return scene;
  }

 private:
  std::size_t below(std::size_t n) { return random_() % n; }
  double real(double low, double high) {
    return low + (high - low) * static_cast<double>(random_()) / 4294967296.0;
  }

  Grid make_grid() {
    Grid grid;
    for (auto& n : grid.size) {
      n = below(6) == 0 ? 1 : 2 + static_cast<std::int64_t>(below(static_cast<std::size_t>(max_side_ - 1)));
    }
    const bool isotropic = below(3) == 0;
    for (double& mm : grid.spacing_mm) mm = isotropic ? 1 : std::exp(real(-1, 1));
    for (double& mm : grid.origin_lps_mm) mm = real(-100, 100);
    std::array<std::size_t, 3> axes{0, 1, 2};
    for (std::size_t n = 2; n > 0; --n) std::swap(axes[n], axes[below(n + 1)]);
    const double skew = below(2) == 0 ? 0 : 0.3;  // oblique, not quite orthogonal: an affine grid
    grid.direction_lps = {};
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t row = 0; row < 3; ++row) grid.direction_lps[3 * row + a] = real(-skew, skew);
      grid.direction_lps[3 * axes[a] + a] = below(2) == 0 ? 1 : -1;
    }
    return grid;
  }

  std::vector<bool> make_structure_mask(const Index3& size) {
    const std::size_t kind = below(4);
    std::array<double, 3> center{};
    std::array<double, 3> radius{};
    for (std::size_t a = 0; a < 3; ++a) {
      center[a] = real(0, static_cast<double>(size[a] - 1));
      radius[a] = real(0.6, std::max(1.0, 0.7 * static_cast<double>(size[a])));
    }
    return make_mask(size, [&](std::int64_t i, std::int64_t j, std::int64_t k) {
      const std::array<double, 3> d{(static_cast<double>(i) - center[0]) / radius[0],
                                    (static_cast<double>(j) - center[1]) / radius[1],
                                    (static_cast<double>(k) - center[2]) / radius[2]};
      if (kind == 0) return below(3) == 0;
      if (kind == 1) return std::max({std::abs(d[0]), std::abs(d[1]), std::abs(d[2])}) < 1;
      return d[0] * d[0] + d[1] * d[1] + d[2] * d[2] < 1;
    });
  }

  Rgb make_color() {
    const auto channel = [&] { return static_cast<std::uint8_t>(below(256)); };
    return {channel(), channel(), channel()};
  }

  VoxelBuffer make_grey_values(std::int64_t voxels) {
    VoxelBuffer values;
    values.type = static_cast<VoxelType>(below(9));
    if (values.type == VoxelType::kNone) return values;
    visit_voxel_type(values.type, [&](auto tag) {
      using T = decltype(tag);
      std::vector<T> typed;
      for (std::int64_t n = 0; n < voxels; ++n) {
        if constexpr (std::is_floating_point_v<T>) {
          typed.push_back(below(20) == 0 ? std::numeric_limits<T>::quiet_NaN()
                                         : static_cast<T>(real(-50, 250)));
          if (below(20) == 0) typed.back() = std::numeric_limits<T>::infinity();
        } else {
          const int lowest = std::is_signed_v<T> ? -60 : 0;
          typed.push_back(static_cast<T>(lowest + static_cast<int>(below(250))));
        }
      }
      values = make_values(values.type, typed);
    });
    return values;
  }

  Selection make_selection(std::size_t structures) {
    static constexpr std::array kModes{DrawMode::kOff,     DrawMode::kVolume, DrawMode::kVolume,
                                       DrawMode::kSurface, DrawMode::kBoth,   DrawMode::kBoth};
    Selection selection;
    selection.structures.resize(structures);
    for (StructureDraw& draw : selection.structures) {
      const DrawMode mode = kModes[below(kModes.size())];
      if (mode == DrawMode::kOff) continue;
      draw.mode = mode;
      draw.color = make_color();
      draw.term = static_cast<std::uint32_t>(below(3));
      switch (below(4)) {
        case 0: break;
        case 1: draw.opacity = static_cast<float>(std::pow(10.0, real(-6, 0))); break;
        case 2: draw.opacity = static_cast<float>(real(0.05, 0.95)); break;
        default: draw.opacity = 1.0f; break;
      }
      if (below(2) == 0) draw.volume = make_style();
    }
    return selection;
  }

  VolumeStyle make_style() {
    VolumeStyle style;
    if (below(3) == 0) {
      style.curve = std::make_shared<const TransferCurve>(make_curve());
      return style;
    }
    style.profile = static_cast<TransferProfile>(below(3));
    if (below(2) == 0) style.low = real(-70, 120);
    if (below(2) == 0) style.high = style.low.value_or(60) + real(1, 120);
    return style;
  }

  TransferCurve make_curve() {
    TransferCurve curve;
    double grey = real(-60, 60);
    for (std::size_t points = 1 + below(5); points > 0; --points) {
      const float opacity = below(3) == 0 ? 0 : static_cast<float>(0.9999 * std::pow(real(0, 1), 3));
      curve.points.push_back({grey, opacity, static_cast<float>(real(0, 1))});
      grey += below(3) == 0 ? 1e-6 : real(1, 100);
    }
    return curve;
  }

  void make_view(RandomScene& scene) {
    Camera& camera = scene.camera;
    bool diagonal = false;
    if (below(5) == 0) {
      camera = Camera::of(static_cast<NamedView>(below(6)));
    } else if (below(5) == 0) {
      diagonal = true;
      camera.azimuth_deg = 45.0 * static_cast<double>(below(8));
      camera.elevation_deg = 45.0 * static_cast<double>(below(3)) - 45;
    } else {
      camera.azimuth_deg = real(-360, 360);
      camera.elevation_deg = real(-90, 90);
    }
    camera.zoom = std::exp(real(-1.2, 2));
    if (below(2) == 0) {
      Vec3 center = scene.content.display.center_lps_mm;
      for (double& mm : center) mm += real(-0.7, 0.7) * scene.content.display.radius_mm;
      camera.center_lps_mm = center;
    }
    scene.options.size = {1 + static_cast<int>(below(40)), 1 + static_cast<int>(below(40))};
    scene.options.quality = std::array{Quality::kDraft, Quality::kNormal, Quality::kHigh}[below(3)];
    // Where normals are exactly at right angles to the view, rounding decides which side is lit.
    scene.options.hybrid_shading = below(4) != 0 && !diagonal;
    scene.options.simd = below(4) != 0;
  }

  std::mt19937 random_;
  std::int64_t max_side_;
};

}  // namespace

RandomScene random_scene(std::uint32_t number, std::int64_t max_side) {
  return SceneMaker(number, max_side).make();
}

std::string describe(const RandomScene& scene) {
  const Grid grid = storage_grid(scene.content);
  std::string text = fmt::format(
      "{}x{}x{} voxels of {}, {}x{} pixels, quality {}, azimuth {} elevation {} zoom {};", grid.size[0],
      grid.size[1], grid.size[2], name_of(scene.content.values.type), scene.options.size.width,
      scene.options.size.height, static_cast<int>(scene.options.quality), scene.camera.azimuth_deg,
      scene.camera.elevation_deg, scene.camera.zoom);
  for (const StructureDraw& draw : scene.selection.structures) {
    text += fmt::format(" {} {}", name_of(draw.mode), draw.opacity.value_or(-1));
    if (draw.volume != VolumeStyle{}) text += draw.volume.curve ? " curve" : " ramp";
  }
  return text;
}

}  // namespace splatlas

#include "tests/support/random_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <random>

#include <fmt/format.h>

namespace splatlas {
namespace {

/// Makes one scene, by the bits of the generator: standard distributions differ between implementations.
class SceneMaker {
 public:
  SceneMaker(std::mt19937 random, std::int64_t max_side) : random_(random), max_side_(max_side) {}

  /// `whole`: a scene of whole_scene().
  RandomScene make(bool whole) {
    TestVolume volume;
    volume.grid = make_grid();
    if (whole) stretch(volume.grid);
    const std::size_t structures = whole ? 2 + below(6) : 1 + below(4);
    for (std::size_t s = 0; s < structures; ++s)
      volume.structures.push_back(whole ? make_node(s, volume.grid) : make_structure(s, volume.grid));
    const std::int64_t voxels = volume.grid.voxels();
    volume.values = whole && below(3) == 0 ? make_odd_values(voxels) : make_grey_values(voxels);
    volume.window_low = real(-20, 60);
    volume.window_high = below(10) == 0 ? volume.window_low : volume.window_low + real(10, 200);
    RandomScene scene{make_content(volume), {}, {}, {}};
    scene.selection = whole && below(2) != 0 ? selection_of(make_words(structures), scene.content.graph)
                                             : make_selection(structures);
    make_view(scene);
    if (whole) make_rays(scene);
    return scene;
  }

  void add_cuts(RandomScene& scene) {
    const Display& display = scene.content.display;
    const View view = *view_of(scene.camera, scene.options.size, display);
    scene.options.caps = std::array{CapMode::kBoth, CapMode::kBoth, CapMode::kLabels, CapMode::kValues,
                                    CapMode::kNone}[below(5)];
    const std::size_t count = below(2) == 0 ? 1 : 1 + below(CutPlanes::kMax);
    for (std::size_t n = 0; n < count; ++n) {
      CutPlane plane;
      if (n > 0 && below(4) == 0) {  // parallel to the first
        plane.normal_lps = scene.options.cuts.begin()->normal_lps;
        for (double& component : plane.normal_lps) component *= -1.5;
      } else {
        plane.normal_lps = make_normal(view.plane);
      }
      Vec3 through = display.center_lps_mm;
      for (double& mm : through) mm += real(-0.4, 0.4) * display.radius_mm;
      plane.offset_mm = 0;
      for (std::size_t a = 0; a < 3; ++a) plane.offset_mm += plane.normal_lps[a] * through[a];
      (void)scene.options.cuts.add(plane);
    }
  }

 private:
  Vec3 make_normal(const ParallelView& view) {
    const double sign = below(2) == 0 ? 1 : -1;
    Vec3 normal{};
    switch (below(5)) {
      case 0: normal[below(3)] = 1; break;
      case 1: normal = view.forward_lps; break;
      case 2:  // along the view
        for (std::size_t a = 0; a < 3; ++a) normal[a] = view.right_lps[a] + 0.3 * view.up_lps[a];
        break;
      default:
        for (double& component : normal) component = real(-1, 1);
        break;
    }
    for (double& component : normal) component *= sign;
    return normal;
  }

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

  /// Anisotropic voxels; distant, tiny and huge grids.
  void stretch(Grid& grid) {
    if (below(8) == 0) grid.spacing_mm[below(3)] *= 50;
    const double scale = below(8) == 0 ? std::pow(10.0, real(-6, 6)) : 1;
    const double away = below(8) == 0 ? 1000 : 1;
    for (std::size_t a = 0; a < 3; ++a) {
      grid.spacing_mm[a] *= scale;
      grid.origin_lps_mm[a] *= scale * away;
    }
  }

  TestStructure make_structure(std::size_t s, const Grid& grid) {
    TestStructure structure{fmt::format("s{}", s), make_structure_mask(grid.size)};
    structure.color = make_color();
    if (s > 0 && below(3) == 0) structure.parents = {static_cast<StructureIndex>(below(s))};
    return structure;
  }

  /// A structure, a group or an external surface, with up to three parents.
  TestStructure make_node(std::size_t s, const Grid& grid) {
    TestStructure node{fmt::format("s{}", s), {}};
    const std::size_t kind = below(6);
    if (kind == 0) {
      node.external = make_external(reordered(grid, storage_order(grid)).size);
    } else if (kind > 1) {
      node.mask = make_structure_mask(grid.size);
    }
    node.color = make_color();
    for (StructureIndex parent = 0; parent < s; ++parent) {
      if (node.parents.size() < 3 && below(s + 1) == 0) node.parents.push_back(parent);
    }
    return node;
  }

  /// Triangles anywhere in the grid: general, slivers, in planes of voxel centres, degenerate, duplicate.
  SurfaceMesh make_external(const Index3& size) {
    constexpr std::uint32_t kScale = 64;
    SurfaceMesh mesh;
    mesh.position_scale = kScale;
    for (std::size_t triangles = 1 + below(40); triangles > 0; --triangles) {
      const auto first = static_cast<std::uint32_t>(mesh.positions_ijk.size());
      std::array<float, 3> voxel{};
      for (std::size_t a = 0; a < 3; ++a)
        voxel[a] = static_cast<float>(below(static_cast<std::size_t>(size[a])));
      const std::size_t flat = below(6);  // normal to this axis, if there is one
      for (std::uint32_t corner = 0; corner < 3; ++corner) {
        std::array<float, 3> place{};
        for (std::size_t a = 0; a < 3; ++a) {
          const float within = static_cast<float>(below(kScale - 1)) / kScale - 31.0f / kScale;
          place[a] = voxel[a] + (a == flat ? 0 : within);
        }
        if (corner > 0 && below(12) == 0) place = mesh.positions_ijk.back();
        mesh.positions_ijk.push_back(place);
        mesh.normals_lps.push_back(unpack_normal(static_cast<PackedNormal>(below(65536))));
      }
      mesh.triangles.push_back({first, first + 1, first + 2});
      if (below(12) == 0) mesh.triangles.push_back(mesh.triangles.back());
    }
    return mesh;
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

  /// Constant, denormal, infinite, and the minimum and maximum of the type.
  VoxelBuffer make_odd_values(std::int64_t voxels) {
    VoxelBuffer values;
    values.type = static_cast<VoxelType>(1 + below(8));
    const bool constant = below(3) == 0;
    visit_voxel_type(values.type, [&](auto tag) {
      using T = decltype(tag);
      using Limits = std::numeric_limits<T>;
      std::vector<T> odd{T{0}, T{1}, Limits::max(), Limits::lowest(), static_cast<T>(60)};
      if constexpr (std::is_floating_point_v<T>) {
        odd.insert(odd.end(), {Limits::denorm_min(), -Limits::denorm_min(), Limits::min(), Limits::infinity(),
                               -Limits::infinity(), Limits::quiet_NaN(), T{-0.0f}, static_cast<T>(1e-30)});
      }
      std::vector<T> typed(static_cast<std::size_t>(voxels), odd[below(odd.size())]);
      for (T& value : typed) {
        if (!constant) value = below(2) == 0 ? odd[below(odd.size())] : static_cast<T>(real(0, 100));
      }
      values = make_values(values.type, typed);
    });
    return values;
  }

  /// Up to six terms, some of them removals.
  std::string make_words(std::size_t structures) {
    static constexpr std::array kModes{"", ":volume", ":surface", ":both", ":both"};
    std::string words = below(3) == 0 ? "s*:both(opacity=0.4)" : "";
    for (std::size_t terms = 1 + below(5); terms > 0; --terms) {
      const bool remove = !words.empty() && below(3) == 0;
      if (!words.empty()) words += remove ? " - " : " + ";
      // One draw a statement: all compilers draw alike
      const char* const mode = kModes[below(kModes.size())];
      words += fmt::format("s{}{}", below(structures), mode);
      if (remove || below(3) == 0) continue;
      words += fmt::format("(opacity={:.6f}", below(4) == 0 ? 1 : real(1e-6, 1));
      if (below(3) == 0) {
        const double high = real(51, 200);
        words += fmt::format(",low={:.3f},high={:.3f}", real(-70, 50), high);
      }
      if (below(4) == 0) words += below(2) == 0 ? ",profile=thin" : ",profile=hard";
      words += ")";
    }
    return words;
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
      draw.ghost = draw.color.r % 6 == 0;  // no random number more: the scenes of a seed stay
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
    // Rounding chooses the lit side of normals that are exactly perpendicular to the view.
    scene.options.hybrid_shading = below(4) != 0 && !diagonal;
    scene.overrides.simd = below(4) != 0;
  }

  /// Draws every other scene by ray casting.
  void make_rays(RandomScene& scene) {
    if (below(2) == 0) return;
    scene.options.size.width = std::min(scene.options.size.width, 20);
    scene.options.size.height = std::min(scene.options.size.height, 20);
    if (below(3) != 0) {
      scene.camera.projection = CameraProjection::kPerspective;
      scene.camera.field_of_view_deg = std::array{0.01, 20.0, 50.0, 90.0, 150.0}[below(5)];
    }
    const bool after = scene.camera.projection == CameraProjection::kParallel || below(2) == 0;
    if (!after) return;
    scene.options.classification = Classification::kAfter;
    scene.options.hybrid_shading = false;  // the reference is unlit
  }

  std::mt19937 random_;
  std::int64_t max_side_;
};

}  // namespace

RandomScene random_scene(std::uint32_t number, std::int64_t max_side) {
  return SceneMaker(std::mt19937(number), max_side).make(false);
}

RandomScene whole_scene(std::uint32_t seed, std::uint32_t number) {
  std::seed_seq both{seed, number};
  return SceneMaker(std::mt19937(both), 10).make(true);
}

RandomScene cut_scene(std::uint32_t seed, std::uint32_t number) {
  std::seed_seq both{seed, number};
  SceneMaker maker(std::mt19937(both), 10);
  RandomScene scene = maker.make(true);
  maker.add_cuts(scene);
  return scene;
}

std::string describe(const RandomScene& scene) {
  const Grid grid = storage_grid(scene.content);
  std::string text = fmt::format(
      "{}x{}x{} voxels of {}, {}x{} pixels, quality {}, azimuth {} elevation {} zoom {}{};", grid.size[0],
      grid.size[1], grid.size[2], name_of(scene.content.values.type), scene.options.size.width,
      scene.options.size.height, static_cast<int>(scene.options.quality), scene.camera.azimuth_deg,
      scene.camera.elevation_deg, scene.camera.zoom,
      scene.camera.projection == CameraProjection::kPerspective
          ? fmt::format(" field of view {}", scene.camera.field_of_view_deg)
          : "");
  for (const CutPlane& plane : scene.options.cuts) {
    const auto& [x, y, z] = plane.normal_lps;
    text += fmt::format(" cut {},{},{},{};", x, y, z, plane.offset_mm);
  }
  if (scene.options.classification == Classification::kAfter) text += " classified after interpolation;";
  for (const StructureDraw& draw : scene.selection.structures) {
    text += fmt::format(" {} {}", name_of(draw.mode), draw.opacity.value_or(-1));
    if (draw.ghost) text += " ghost";
    if (draw.volume != VolumeStyle{}) text += draw.volume.curve ? " curve" : " ramp";
  }
  return text;
}

}  // namespace splatlas

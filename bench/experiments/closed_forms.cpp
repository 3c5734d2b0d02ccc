#include "bench/experiments/closed_forms.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <span>

#include <fmt/format.h>

#include "format/result_macros.h"
#include "tests/reference/ray.h"
#include "tests/support/render.h"

namespace splatlas {
namespace {

constexpr std::int64_t kWide = 72, kThick = 7;  // voxels of 1 mm
constexpr std::array kOpacities{0.03f, 0.3f};   // per voxel
constexpr PictureSize kPlateSize{15, 15};
/// Margin of rays to the border of the large faces: footprints reach one voxel.
constexpr double kMarginMm = 2;
constexpr double kFieldOfViewDeg = 10;

/// A plate with its large faces normal to `axis`.
AtlasContent plate(std::size_t axis) {
  Index3 size{kWide, kWide, kWide};
  size[axis] = kThick;
  return make_content(
      {.grid = {.size = size}, .structures = {{"plate", make_mask(size, [](auto...) { return true; })}}});
}

/// Derives numbers from the bits of the generator, as standard distributions differ between implementations.
Camera random_camera(const Display& display, CameraProjection projection, std::mt19937& random) {
  const auto real = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
  };
  Camera camera{.projection = projection, .field_of_view_deg = kFieldOfViewDeg};
  camera.azimuth_deg = real(-180, 180);
  camera.elevation_deg = std::asin(real(-1, 1)) * 180 / std::numbers::pi;
  camera.zoom = zoom_for(display, kPlateSize.width, std::exp2(real(-3.5, 0)));
  camera.center_lps_mm = display.center_lps_mm;
  for (double& mm : *camera.center_lps_mm) mm += real(-0.5, 0.5);
  return camera;
}

/// One plate in one view.
struct PlateView {
  const Grid& grid;
  std::size_t axis;
  View view;

  /// The ray of pixel (x, y) in voxels, with a direction of 1 mm.
  [[nodiscard]] reference::Ray ray(int x, int y) const {
    const reference::Ray parallel = reference::ray_through(view.plane, grid, x + 0.5, y + 0.5);
    if (!view.eye_mm) return parallel;
    const Vec3 eye = lps_mm_to_index(grid).apply(view.eye_lps_mm());
    reference::Ray ray{eye, reference::minus(parallel.start, eye)};
    const double length = std::sqrt(dot(ray.per_mm, ray.per_mm));  // voxels of 1 mm
    for (double& step : ray.per_mm) step /= length;
    return ray;
  }

  /// True if the ray crosses both large faces, well inside their borders.
  [[nodiscard]] bool crosses_faces(const reference::Ray& ray) const {
    if (std::abs(ray.per_mm[axis]) < 0.2) return false;
    for (const double face : {-1.0, static_cast<double>(kThick)}) {
      const double along_mm = (face - ray.start[axis]) / ray.per_mm[axis];
      if (view.eye_mm && along_mm < 0) return false;  // the eye is inside or behind the plate
      const Vec3 at = ray.at(along_mm);
      for (std::size_t a = 0; a < 3; ++a) {
        if (a != axis && (at[a] < kMarginMm || at[a] > static_cast<double>(kWide - 1) - kMarginMm)) {
          return false;
        }
      }
    }
    return true;
  }
  [[nodiscard]] bool all_cross_faces() const {
    return crosses_faces(ray(0, 0)) && crosses_faces(ray(kPlateSize.width - 1, 0)) &&
           crosses_faces(ray(0, kPlateSize.height - 1)) &&
           crosses_faces(ray(kPlateSize.width - 1, kPlateSize.height - 1));
  }
};

/// Errors against the closed form, by the main axis of the ray.
void compare(const Picture& picture, const PlateView& plate_view, float opacity, Ripple& ripple) {
  for (int y = 0; y < kPlateSize.height; ++y) {
    for (int x = 0; x < kPlateSize.width; ++x) {
      const Vec3 per_mm = plate_view.ray(x, y).per_mm;
      const double along = std::abs(per_mm[plate_view.axis]);
      const double length = kThick / along;
      const double expected = -std::expm1(length * std::log1p(-static_cast<double>(opacity)));
      const bool side =
          std::any_of(per_mm.begin(), per_mm.end(), [&](double step) { return std::abs(step) > along; });
      double& largest = side ? ripple.side_faces : ripple.faces_of_slices;
      for (const float value : picture.at(x, y)) largest = std::max(largest, std::abs(value - expected));
    }
  }
}

Selection white_plate(const AtlasContent& content, float opacity) {
  Selection selection = selection_of("plate:volume(color=#ffffff)", content.graph);
  for (StructureDraw& draw : selection.structures) draw.opacity = opacity;
  return selection;
}

Result<void> measure_plate(std::size_t axis, Quality quality, CameraProjection projection, int views,
                           Ripple& ripple) {
  const AtlasContent content = plate(axis);
  const Grid grid = storage_grid(content);
  Renderer renderer(open_in_memory(content), {.threads = 1});
  std::mt19937 random(static_cast<std::uint32_t>(axis));
  const RenderOptions render{.size = kPlateSize, .quality = quality, .hybrid_shading = false};
  for (int measured = 0; measured < views;) {
    const Camera camera = random_camera(content.display, projection, random);
    SPLATLAS_ASSIGN_OR_RETURN(const View view, view_of(camera, kPlateSize, content.display));
    const PlateView plate_view{grid, axis, view};
    if (!plate_view.all_cross_faces()) continue;
    for (const float opacity : kOpacities) {
      SPLATLAS_RETURN_IF_ERROR(renderer.select(white_plate(content, opacity)));
      SPLATLAS_ASSIGN_OR_RETURN(const Frame frame, renderer.render(camera, render));
      compare(frame.picture, plate_view, opacity, ripple);
    }
    ++measured;
  }
  return {};
}

}  // namespace

Result<Ripple> measure_ripple(Quality quality, CameraProjection projection, int views) {
  Ripple ripple;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    SPLATLAS_RETURN_IF_ERROR(measure_plate(axis, quality, projection, views, ripple));
  }
  return ripple;
}
namespace {

/// A Gaussian in the middle of a cube, at whose faces it vanishes: the grey values of one structure.
/// Extinction is proportional to it, white does not depend on it.
constexpr double kSideMm = 48, kWidthMm = 4;
constexpr double kExtinctionPerMm = 0.15;

/// A close-up, in which every quality has its finest sheets on every grid: eight pixels per voxel of the
/// coarsest grid, four of the finest.
constexpr PictureSize kSize{40, 40};
constexpr double kMmPerPixel = 0.1875;
constexpr std::array kVoxelsMm{1.5, 1.0, 0.75};
/// Off all symmetries; principal axes z, y and x.
constexpr std::array<std::array<double, 2>, 3> kDirections{{{17, 62}, {25, 14}, {68, -21}}};

struct Method {
  const char* name;
  Quality quality;
  Classification classification;
};
constexpr std::array kMethods{Method{"sheets, draft", Quality::kDraft, Classification::kBefore},
                              Method{"sheets, normal", Quality::kNormal, Classification::kBefore},
                              Method{"rays before, high", Quality::kHigh, Classification::kBefore},
                              Method{"rays after, high", Quality::kHigh, Classification::kAfter}};

/// Samples of the field at the centres of cubic voxels.
AtlasContent sampled_field(double voxel_mm) {
  const auto side = static_cast<std::int64_t>(std::lround(kSideMm / voxel_mm));
  const double first = 0.5 * (voxel_mm - kSideMm);
  TestVolume volume;
  volume.grid = {
      {side, side, side}, {voxel_mm, voxel_mm, voxel_mm}, {first, first, first}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};
  std::vector<float> greys;
  volume.structures = {{"field", make_mask(volume.grid.size, [&](auto i, auto j, auto k) {
                          const auto mm = [&](auto n) { return first + voxel_mm * static_cast<double>(n); };
                          const double squares = mm(i) * mm(i) + mm(j) * mm(j) + mm(k) * mm(k);
                          greys.push_back(
                              static_cast<float>(std::exp(-0.5 * squares / (kWidthMm * kWidthMm))));
                          return true;
                        })}};
  volume.values = make_values(VoxelType::kFloat32, greys);
  return make_content(volume);
}

/// Sum of the squares of the errors of a picture. The optical depth of a ray has a closed form.
double mean_square_error(const Picture& picture, const ParallelView& view) {
  double squares = 0;
  for (int n = 0; n < kSize.width * kSize.height; ++n) {
    const int x = n % kSize.width, y = n / kSize.width;
    const Vec3 point = view.point_lps_mm(x + 0.5, y + 0.5);
    const double along = dot(point, view.forward_lps);
    const double distance_2 = dot(point, point) - along * along;
    const double depth = kExtinctionPerMm * kWidthMm * std::sqrt(2 * std::numbers::pi) *
                         std::exp(-0.5 * distance_2 / (kWidthMm * kWidthMm));
    for (const float value : picture.at(x, y))
      squares += std::pow(static_cast<double>(value) + std::expm1(-depth), 2) / 4;
  }
  return squares / (kSize.width * kSize.height);
}

/// Least-squares slope of log(error) over log(voxel).
double observed_order(std::span<const double> errors) {
  double x_mean = 0, y_mean = 0, xy = 0, xx = 0;
  const auto count = static_cast<double>(errors.size());
  for (std::size_t n = 0; n < errors.size(); ++n) {
    x_mean += std::log(kVoxelsMm[n]) / count;
    y_mean += std::log(errors[n]) / count;
  }
  for (std::size_t n = 0; n < errors.size(); ++n) {
    const double x = std::log(kVoxelsMm[n]) - x_mean;
    xy += x * (std::log(errors[n]) - y_mean);
    xx += x * x;
  }
  return xy / xx;
}

}  // namespace

Result<std::vector<Convergence>> measure_convergence() {
  std::vector<Convergence> rows;
  for (const Method& method : kMethods) {
    Convergence& row = rows.emplace_back(Convergence{.renderer = method.name, .errors = {}});
    for (const double voxel_mm : kVoxelsMm) {
      const AtlasContent content = sampled_field(voxel_mm);
      const double opacity = -std::expm1(-kExtinctionPerMm * voxel_mm);
      Renderer renderer(open_in_memory(content));
      SPLATLAS_RETURN_IF_ERROR(renderer.select(selection_of(
          fmt::format("field:volume(color=#ffffff,curve=0:0:1/1:{:.12f}:1)", opacity), content.graph)));
      double squares = 0;
      for (const auto& [azimuth, elevation] : kDirections) {
        const Camera camera{.azimuth_deg = azimuth,
                            .elevation_deg = elevation,
                            .zoom = zoom_for(content.display, kSize.width, kMmPerPixel),
                            .center_lps_mm = Vec3{0.3, -0.2, 0.1}};
        SPLATLAS_ASSIGN_OR_RETURN(const ParallelView view, parallel_view(camera, kSize, content.display));
        SPLATLAS_ASSIGN_OR_RETURN(const Frame frame,
                                  renderer.render(camera, {.size = kSize,
                                                           .quality = method.quality,
                                                           .classification = method.classification,
                                                           .hybrid_shading = false,
                                                           .termination_threshold = 0.0f}));
        squares += mean_square_error(frame.picture, view);
      }
      row.errors.push_back(std::sqrt(squares / static_cast<double>(kDirections.size())));
    }
    row.order = observed_order(row.errors);
  }
  return rows;
}

}  // namespace splatlas

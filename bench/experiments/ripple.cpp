#include "bench/experiments/ripple.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "format/result_macros.h"
#include "tests/reference/ray.h"
#include "tests/support/render.h"

namespace splatlas {
namespace {

constexpr std::int64_t kWide = 72, kThick = 7;  // voxels of 1 mm
constexpr std::array kOpacities{0.03f, 0.3f};   // per voxel
constexpr PictureSize kSize{15, 15};
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
class RandomViews {
 public:
  explicit RandomViews(std::uint32_t seed) : random_(seed) {}

  Camera next(const AtlasContent& content, const RippleOptions& options) {
    Camera camera;
    camera.azimuth_deg = real(-180, 180);
    camera.elevation_deg = std::asin(real(-1, 1)) * 180 / std::numbers::pi;
    camera.zoom = zoom_for(content.display, kSize.width, std::exp2(real(-3.5, 0)));
    Vec3 center = content.display.center_lps_mm;
    for (double& mm : center) mm += real(-0.5, 0.5);
    camera.center_lps_mm = center;
    camera.projection = options.projection;
    camera.field_of_view_deg = kFieldOfViewDeg;
    return camera;
  }

 private:
  double real(double low, double high) {
    return low + (high - low) * static_cast<double>(random_()) / 4294967296.0;
  }
  std::mt19937 random_;
};

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
    const double length = std::sqrt(reference::dot(ray.per_mm, ray.per_mm));  // voxels of 1 mm
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
    return crosses_faces(ray(0, 0)) && crosses_faces(ray(kSize.width - 1, 0)) &&
           crosses_faces(ray(0, kSize.height - 1)) && crosses_faces(ray(kSize.width - 1, kSize.height - 1));
  }
};

/// Errors against the closed form, by the main axis of the ray.
void compare(const Picture& picture, const PlateView& plate_view, float opacity, Ripple& ripple) {
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      const Vec3 per_mm = plate_view.ray(x, y).per_mm;
      const double along = std::abs(per_mm[plate_view.axis]);
      const double length = kThick / along;
      const double expected = -std::expm1(length * std::log1p(-static_cast<double>(opacity)));
      const bool side =
          std::any_of(per_mm.begin(), per_mm.end(), [&](double step) { return std::abs(step) > along; });
      double& largest = side ? ripple.side_faces : ripple.faces_of_slices;
      for (const float value : picture.at(x, y)) largest = std::max(largest, std::abs(value - expected));
      ++(side ? ripple.side_pixels : ripple.pixels);
    }
  }
}

Selection white_plate(const AtlasContent& content, float opacity) {
  Selection selection = selection_of("plate:volume(color=#ffffff)", content.graph);
  for (StructureDraw& draw : selection.structures) draw.opacity = opacity;
  return selection;
}

Result<void> measure_plate(std::size_t axis, const RippleOptions& options, Ripple& ripple) {
  const AtlasContent content = plate(axis);
  const Grid grid = storage_grid(content);
  Renderer renderer(open_in_memory(content), {.threads = 1});
  RandomViews views(static_cast<std::uint32_t>(axis));
  const RenderOptions render{.size = kSize, .quality = options.quality, .hybrid_shading = false};
  for (int measured = 0; measured < options.views;) {
    const Camera camera = views.next(content, options);
    SPLATLAS_ASSIGN_OR_RETURN(const View view, view_of(camera, kSize, content.display));
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

Result<Ripple> measure_ripple(const RippleOptions& options) {
  Ripple ripple;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    SPLATLAS_RETURN_IF_ERROR(measure_plate(axis, options, ripple));
  }
  return ripple;
}

}  // namespace splatlas

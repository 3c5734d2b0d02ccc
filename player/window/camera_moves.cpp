#include "player/window/camera_moves.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace splatlas {
namespace {

constexpr std::array<NamedView, 6> kNamedViews{NamedView::kAnterior, NamedView::kPosterior,
                                               NamedView::kLeft,     NamedView::kRight,
                                               NamedView::kSuperior, NamedView::kInferior};
constexpr double kDegreesPerSide = 180;
/// A direction is also called after an axis when its component along it is at least this: sin 22.5 degrees.
constexpr double kMinComponent = 0.3827;

}  // namespace

Camera turned(const Camera& camera, double azimuth_deg, double elevation_deg) {
  Camera result = camera;
  result.azimuth_deg = std::remainder(camera.azimuth_deg + azimuth_deg, 360.0);
  if (result.azimuth_deg <= -180) result.azimuth_deg += 360;
  result.elevation_deg = std::clamp(camera.elevation_deg + elevation_deg, -90.0, 90.0);
  return result;
}

Camera turned_by_drag(const Camera& camera, double dx, double dy, const PictureSize& size) {
  const double degrees_per_pixel = kDegreesPerSide / std::max(1, std::min(size.width, size.height));
  return turned(camera, -dx * degrees_per_pixel, dy * degrees_per_pixel);
}

Camera zoomed_at(const Camera& camera, double factor, double x, double y, const PictureSize& size,
                 const Display& display) {
  Camera result = camera;
  result.zoom = std::clamp(camera.zoom * factor, kMinZoom, kMaxZoom);
  const auto before = parallel_view(camera, size, display);
  const auto after = parallel_view(result, size, display);
  if (!before || !after) return camera;
  const Vec3 was = before->point_lps_mm(x, y), is = after->point_lps_mm(x, y);
  Vec3 center = before->center_lps_mm;
  for (std::size_t a = 0; a < 3; ++a) center[a] += was[a] - is[a];
  result.center_lps_mm = center;
  return result;
}

Camera moved_by_drag(const Camera& camera, double dx, double dy, const PictureSize& size,
                     const Display& display) {
  const auto view = parallel_view(camera, size, display);
  if (!view) return camera;
  Camera result = camera;
  Vec3 center = view->center_lps_mm;
  for (std::size_t a = 0; a < 3; ++a) {
    center[a] += (-dx * view->right_lps[a] + dy * view->up_lps[a]) * view->mm_per_pixel;
  }
  result.center_lps_mm = center;
  return result;
}

std::string orientation_letters(const Vec3& direction_lps) {
  constexpr std::array<std::string_view, 3> kLetters{"LR", "PA", "SI"};  // towards +, towards -
  std::array<std::size_t, 3> axes{0, 1, 2};
  std::stable_sort(axes.begin(), axes.end(), [&](std::size_t a, std::size_t b) {
    return std::abs(direction_lps[a]) > std::abs(direction_lps[b]);
  });
  std::string letters;
  for (const std::size_t a : axes) {
    if (std::abs(direction_lps[a]) >= kMinComponent) letters += kLetters[a][direction_lps[a] < 0 ? 1 : 0];
  }
  return letters;
}

std::optional<NamedView> view_of(const Camera& camera) {
  constexpr double kSameDeg = 1e-6;
  for (const NamedView view : kNamedViews) {
    const Camera named = Camera::of(view);
    if (std::abs(std::remainder(camera.azimuth_deg - named.azimuth_deg, 360.0)) < kSameDeg &&
        std::abs(camera.elevation_deg - named.elevation_deg) < kSameDeg) {
      return view;
    }
  }
  return std::nullopt;
}

std::string_view title_of(NamedView view) {
  constexpr std::array<std::string_view, 6> kTitles{"Anterior", "Posterior", "Left",
                                                    "Right",    "Superior",  "Inferior"};
  return kTitles[static_cast<std::size_t>(view)];
}

}  // namespace splatlas

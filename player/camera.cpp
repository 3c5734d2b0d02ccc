#include "player/camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "format/result_macros.h"

namespace splatlas {
namespace {

/// Diameter of the atlas's bounding sphere at zoom 1, relative to the smaller side of the picture.
constexpr double kFit = 0.96;

/// Sine and cosine of an angle in degrees. Exact at multiples of 90, so that standard views have zero shear.
std::pair<double, double> sin_cos_deg(double degrees) {
  const double turn = std::remainder(degrees, 360.0);
  const double quarter = std::round(turn / 90.0);
  if (turn == quarter * 90.0) {
    constexpr std::array<double, 5> kSin{0, -1, 0, 1, 0};
    constexpr std::array<double, 5> kCos{-1, 0, 1, 0, -1};
    const auto n = static_cast<std::size_t>(quarter + 2.0);
    return {kSin[n], kCos[n]};
  }
  const double radians = turn * std::numbers::pi / 180.0;
  return {std::sin(radians), std::cos(radians)};
}

}  // namespace

tl::unexpected<Error> bad_camera(std::string_view parameter, std::string_view fault) {
  const std::string subject = fmt::format("camera: {}", parameter);
  return tl::unexpected(Error{ErrorCode::kUsage, fmt::format("{} {}", subject, fault), subject});
}

Camera Camera::of(NamedView view) {
  const ViewAngles& angles = kViewAngles[static_cast<std::size_t>(view)];
  return {.azimuth_deg = angles.azimuth_deg, .elevation_deg = angles.elevation_deg};
}

std::string direction_letters(const Vec3& direction_lps) {
  constexpr std::array<const char*, 3> kLetters{"LR", "PA", "SI"};  // towards +, towards -
  const double min_cosine = std::sin(std::numbers::pi / 8) - 1e-9;
  std::array<std::size_t, 3> axes{0, 1, 2};
  std::ranges::stable_sort(axes, [&](std::size_t a, std::size_t b) {
    return std::abs(direction_lps[a]) > std::abs(direction_lps[b]) + 1e-9;
  });
  std::string letters;
  for (const std::size_t a : axes) {
    if (std::abs(direction_lps[a]) >= min_cosine) letters += kLetters[a][direction_lps[a] > 0 ? 0 : 1];
  }
  return letters;
}

Vec3 ParallelView::point_lps_mm(double x, double y) const {
  const double right_mm = (x - 0.5 * size.width) * mm_per_pixel;
  const double up_mm = (0.5 * size.height - y) * mm_per_pixel;
  Vec3 point = center_lps_mm;
  for (std::size_t a = 0; a < 3; ++a) point[a] += right_lps[a] * right_mm + up_lps[a] * up_mm;
  return point;
}

Result<ParallelView> parallel_view(const Camera& camera, const PictureSize& size, const Display& display) {
  if (size.width < 1 || size.height < 1 || size.width > kMaxPictureSide || size.height > kMaxPictureSide) {
    return fail(ErrorCode::kUsage, "picture size {}x{}: each side must be from 1 to {} pixels", size.width,
                size.height, kMaxPictureSide);
  }
  if (!std::isfinite(camera.azimuth_deg)) {
    return bad_camera("azimuth", fmt::format("{} must be a finite angle in degrees", camera.azimuth_deg));
  }
  if (!std::isfinite(camera.elevation_deg)) {
    return bad_camera("elevation", fmt::format("{} must be a finite angle in degrees", camera.elevation_deg));
  }
  if (!(camera.zoom >= kMinZoom && camera.zoom <= kMaxZoom)) {
    return bad_camera("zoom", fmt::format("{} must be from {} to {}", camera.zoom, kMinZoom, kMaxZoom));
  }
  const Vec3 center = camera.center_lps_mm.value_or(display.center_lps_mm);
  if (!is_within_reach(center)) {
    return fail(ErrorCode::kUsage, "camera: the centre must be finite, and within {} mm", kMaxMm);
  }

  const auto [sin_azimuth, cos_azimuth] = sin_cos_deg(camera.azimuth_deg);
  const auto [sin_elevation, cos_elevation] = sin_cos_deg(camera.elevation_deg);
  ParallelView view;
  // The camera stands anterior (-y) of the subject at azimuth 0, on its left (+x) at 90 (LPS).
  view.forward_lps = {-cos_elevation * sin_azimuth, cos_elevation * cos_azimuth, -sin_elevation};
  view.up_lps = {-sin_elevation * sin_azimuth, sin_elevation * cos_azimuth, cos_elevation};
  view.right_lps = {cos_azimuth, sin_azimuth, 0};
  view.center_lps_mm = center;
  const double radius_mm = display.radius_mm > 0 ? display.radius_mm : 1;  // 0: an atlas without voxels
  view.mm_per_pixel = 2.0 * radius_mm / (kFit * std::min(size.width, size.height) * camera.zoom);
  view.size = size;
  return view;
}

Vec3 View::point_lps_mm(double x, double y, double depth_mm) const {
  const Vec3 on_plane = plane.point_lps_mm(x, y), eye = eye_lps_mm();
  Vec3 point{};
  for (std::size_t a = 0; a < 3; ++a) {
    point[a] = eye_mm ? eye[a] + (1 + depth_mm / *eye_mm) * (on_plane[a] - eye[a])
                      : on_plane[a] + depth_mm * plane.forward_lps[a];
  }
  return point;
}

std::optional<PicturePoint> View::picture_point(const Vec3& point_lps_mm) const {
  double right_mm = 0, up_mm = 0, depth_mm = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const double from_center = point_lps_mm[a] - plane.center_lps_mm[a];
    right_mm += from_center * plane.right_lps[a];
    up_mm += from_center * plane.up_lps[a];
    depth_mm += from_center * plane.forward_lps[a];
  }
  const double distance = eye_mm ? 1 + depth_mm / *eye_mm : 1;  // from the eye, in units of eye_mm
  if (!(distance > 0)) return std::nullopt;
  const double mm_per_pixel = plane.mm_per_pixel * distance;
  return PicturePoint{0.5 * plane.size.width + right_mm / mm_per_pixel,
                      0.5 * plane.size.height - up_mm / mm_per_pixel, depth_mm};
}

Vec3 View::eye_lps_mm() const {
  Vec3 eye = plane.center_lps_mm;
  for (std::size_t a = 0; a < 3; ++a) eye[a] -= eye_mm.value_or(0) * plane.forward_lps[a];
  return eye;
}

Result<View> view_of(const Camera& camera, const PictureSize& size, const Display& display) {
  SPLATLAS_ASSIGN_OR_RETURN(const ParallelView plane, parallel_view(camera, size, display));
  if (camera.projection == CameraProjection::kParallel) return View{plane};
  const double degrees = camera.field_of_view_deg;
  if (!(degrees >= kMinFieldOfView && degrees <= kMaxFieldOfView)) {
    return bad_camera("field of view", fmt::format("{} must be from {} to {} degrees", degrees,
                                                   kMinFieldOfView, kMaxFieldOfView));
  }
  const double half_height_mm = 0.5 * size.height * plane.mm_per_pixel;
  const double eye_mm = half_height_mm / std::tan(degrees * std::numbers::pi / 360);
  if (!(eye_mm >= kMinEyeDistanceMm && std::isfinite(eye_mm))) {
    return bad_camera("zoom", fmt::format("{}: the eye is {} mm from the point that it looks at; change it",
                                          camera.zoom, eye_mm));
  }
  return View{plane, eye_mm};
}

}  // namespace splatlas

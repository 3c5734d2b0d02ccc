#include "player/render/view/fit_extents.h"

#include <cmath>

#include "format/result_macros.h"

namespace splatlas {
namespace {

/// Order of FitPlanes.
enum : std::size_t { kUp, kDown, kRight, kLeft, kFar, kNear };

/// Distance of the eye from the nearest point, relative to the depth of all points.
constexpr double kMinEyeDistance = 1e-3;

}  // namespace

void FitExtents::grow(const FitPlanes& planes, double reach) {
  for (std::size_t n = 0; n < FitPlanes::kCount; ++n) {
    const Vec3& gradient = planes.gradient[n];
    max_[n] += reach * (std::abs(gradient[0]) + std::abs(gradient[1]) + std::abs(gradient[2]));
  }
}

Result<FitFrame> FitFrame::of(const Camera& camera, const PictureSize& size, const Display& display,
                              const PictureRegion& region) {
  const bool is_inside = region.left >= 0 && region.left < region.right && region.right <= 1 &&
                         region.top >= 0 && region.top < region.bottom && region.bottom <= 1;
  if (!is_inside) {
    return fail(ErrorCode::kUsage,
                "camera: region of the picture from ({}, {}) to ({}, {}): must lie within (0, 0) to (1, 1)",
                region.left, region.top, region.right, region.bottom);
  }
  Camera whole = camera;
  whole.zoom = 1;
  whole.center_lps_mm.reset();
  SPLATLAS_ASSIGN_OR_RETURN(const View view, view_of(whole, size, display));
  return FitFrame(whole, view, region);
}

FitFrame::FitFrame(const Camera& camera, const View& view, const PictureRegion& region)
    : camera_(camera),
      view_(view),
      half_height_mm_(0.5 * view.plane.size.height * view.plane.mm_per_pixel),
      slope_(view.eye_mm ? half_height_mm_ / *view.eye_mm : 0) {
  const double aspect = static_cast<double>(view.plane.size.width) / view.plane.size.height;
  middle_right_ = aspect * (region.left + region.right - 1);
  middle_up_ = 1 - region.top - region.bottom;
  half_width_ = kFill * aspect * (region.right - region.left);
  half_height_ = kFill * (region.bottom - region.top);
}

FitPlanes FitFrame::planes(const Affine& to_lps_mm) const {
  // A point is inside the margins if |up - middle_up * h| <= half_height * h, and
  // |right - middle_right * h| <= half_width * h, for h = H + depth * slope and the picture's half height H
  FitPlanes planes;
  Vec3 offset = to_lps_mm.offset;  // from the centre of the bounding sphere
  for (std::size_t a = 0; a < 3; ++a) offset[a] -= view_.plane.center_lps_mm[a];
  const auto set = [&](std::size_t n, const Vec3& side, double sign, double depths) {
    Vec3 normal{};
    for (std::size_t a = 0; a < 3; ++a) normal[a] = sign * side[a] + depths * view_.plane.forward_lps[a];
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t b = 0; b < 3; ++b) planes.gradient[n][a] += normal[b] * to_lps_mm.linear[3 * b + a];
      planes.offset[n] += normal[a] * offset[a];
    }
  };
  set(kUp, view_.plane.up_lps, 1, -(half_height_ + middle_up_) * slope_);
  set(kDown, view_.plane.up_lps, -1, -(half_height_ - middle_up_) * slope_);
  set(kRight, view_.plane.right_lps, 1, -(half_width_ + middle_right_) * slope_);
  set(kLeft, view_.plane.right_lps, -1, -(half_width_ - middle_right_) * slope_);
  set(kFar, {}, 0, 1);
  set(kNear, {}, 0, -1);
  return planes;
}

Camera FitFrame::fitted(const FitExtents& extents) const {
  const auto middle = [&](std::size_t above, std::size_t below) {
    return 0.5 * (extents.max(above) - extents.max(below));
  };
  const auto half = [&](std::size_t above, std::size_t below) {
    return 0.5 * (extents.max(above) + extents.max(below));
  };
  // Find the half height in the plane of depth 0, and the middle of the picture
  double half_height = std::max(half(kUp, kDown) / half_height_, half(kRight, kLeft) / half_width_);
  if (slope_ > 0) {
    const double nearest = -extents.max(kNear) - kMinEyeDistance * half(kFar, kNear);
    half_height = std::max(half_height, -nearest * slope_);
  }
  const double right = middle(kRight, kLeft) - middle_right_ * half_height;
  const double up = middle(kUp, kDown) - middle_up_ * half_height;

  // Move the plane to the middle of the points
  const double depth = middle(kFar, kNear);
  half_height += depth * slope_;
  Camera camera = camera_;
  camera.zoom = half_height > 0 ? std::clamp(half_height_mm_ / half_height, kMinZoom, kMaxZoom) : kMaxZoom;
  Vec3 center = view_.plane.center_lps_mm;
  for (std::size_t a = 0; a < 3; ++a) {
    center[a] +=
        right * view_.plane.right_lps[a] + up * view_.plane.up_lps[a] + depth * view_.plane.forward_lps[a];
  }
  camera.center_lps_mm = center;
  return camera;
}

Result<Camera> within_reach(const Camera& fitted) {
  if (!fitted.center_lps_mm || is_within_reach(*fitted.center_lps_mm)) return fitted;
  const auto& [x, y, z] = *fitted.center_lps_mm;
  return fail(
      ErrorCode::kFailed,
      "the middle of the selection, at ({:.17g}, {:.17g}, {:.17g}) mm, is more than {} mm from the origin; "
      "build the atlas from images with an origin nearer to 0",
      x, y, z, kMaxMm);
}

}  // namespace splatlas

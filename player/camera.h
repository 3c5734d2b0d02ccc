// Where the atlas is looked at from.
#pragma once

#include <cstdint>
#include <optional>

#include "format/atlas_content.h"
#include "format/grid.h"
#include "format/result.h"

namespace splatlas {

/// Standard anatomical views.
enum class NamedView : std::uint8_t { kAnterior, kPosterior, kLeft, kRight, kSuperior, kInferior };

enum class CameraProjection : std::uint8_t { kParallel, kPerspective };

/// A camera that turns around the atlas. Angles follow the contract: azimuth 0 looks at the anterior side, 90
/// at the subject's left; a positive elevation looks down from above. Up on the picture is superior; straight
/// from above or below it is where superior tends to as the elevation approaches 90 degrees.
struct Camera {
  double azimuth_deg = 0;
  double elevation_deg = 0;
  double zoom = 1;  ///< 1 fits the ball around the atlas's structures into the picture
  std::optional<Vec3> center_lps_mm =
      std::nullopt;  ///< what the middle of the picture shows; the ball's centre when not set
  /// In perspective the eye stands where it sees, in the plane of the centre, exactly what a parallel view
  /// shows: zooming in brings it nearer, into the volume at last.
  CameraProjection projection = CameraProjection::kParallel;
  double field_of_view_deg = 30;  ///< of the picture's height, in perspective

  /// superior and inferior look along the body axis with anterior up, as anatomists hold an atlas.
  [[nodiscard]] static Camera of(NamedView view);
};

/// Size of a picture in pixels. Limits keep byte counts and fixed-point rasterisation exact.
struct PictureSize {
  int width = 0, height = 0;
  friend bool operator==(const PictureSize&, const PictureSize&) = default;
};
inline constexpr int kMaxPictureSide = 32768;

/// A parallel view: what each pixel's ray is, in LPS mm. Pixel (0, 0) is the top left one; its centre is at
/// picture coordinates (0.5, 0.5).
struct ParallelView {
  Vec3 right_lps, up_lps, forward_lps;  ///< orthonormal; forward points away from the viewer
  Vec3 center_lps_mm;                   ///< seen in the middle of the picture
  double mm_per_pixel = 1;
  PictureSize size;

  /// A point on the ray through picture coordinates (x, y), in the plane of the centre.
  [[nodiscard]] Vec3 point_lps_mm(double x, double y) const;
};

/// Refuses (kUsage) cameras that are not finite, zooms that are not in [1e-6, 1e6], and pictures smaller than
/// 1x1 or larger than kMaxPictureSide on a side. Allocates nothing.
[[nodiscard]] Result<ParallelView> parallel_view(const Camera& camera, const PictureSize& size,
                                                 const Display& display);

/// A point as a picture shows it.
struct PicturePoint {
  double x = 0, y = 0;  ///< picture coordinates: pixel (0, 0) is from 0 to 1
  double depth_mm = 0;  ///< along the view, from the plane of the centre away from the viewer
};

/// A view in either projection.
struct View {
  ParallelView plane;                           ///< what the plane of the centre looks like
  std::optional<double> eye_mm = std::nullopt;  ///< from the eye to that plane; none: rays are parallel

  /// The point on the ray through picture coordinates (x, y) at `depth_mm` along the view, counted from the
  /// plane of the centre away from the viewer.
  [[nodiscard]] Vec3 point_lps_mm(double x, double y, double depth_mm = 0) const;
  /// Inverse of point_lps_mm(); none for points that are not in front of the eye.
  [[nodiscard]] std::optional<PicturePoint> picture_point(const Vec3& point_lps_mm) const;

  /// Where all rays start, in perspective.
  [[nodiscard]] Vec3 eye_lps_mm() const;
};

/// Narrowest and widest field of view, in degrees.
inline constexpr double kMinFieldOfView = 1e-3, kMaxFieldOfView = 179;
/// From the point that it looks at: no product of the few that rays are made by vanishes.
inline constexpr double kNearestEyeMm = 1e-100;

/// As parallel_view(). In perspective, also refuses fields of view that are not from kMinFieldOfView to
/// kMaxFieldOfView, and an eye that would stand in the plane of the centre or infinitely far away.
[[nodiscard]] Result<View> view_of(const Camera& camera, const PictureSize& size, const Display& display);

}  // namespace splatlas

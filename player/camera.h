// Camera of a picture, the parallel or perspective view that it defines, and its cutting planes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "format/content/atlas_content.h"
#include "format/content/cut_planes.h"
#include "format/content/grid.h"
#include "format/result.h"

namespace splatlas {

/// Projection of the volume onto the picture.
enum class CameraProjection : std::uint8_t { kParallel, kPerspective };

/// Minimum and maximum zoom of a camera.
inline constexpr double kMinZoom = 1e-6, kMaxZoom = 1e6;

/// Orbit camera around a centre in LPS. Azimuth 0 looks at the subject's anterior side, azimuth 90 at the
/// left side. A positive elevation looks down from superior. Superior is up in the picture. At +-90 degrees,
/// the up vector is the limit.
struct Camera {
  double azimuth_deg = 0;
  double elevation_deg = 0;
  /// From kMinZoom to kMaxZoom. At 1, the atlas's bounding sphere fits into the picture;
  /// Renderer::fit() finds the zoom of a selection.
  double zoom = 1;
  std::optional<Vec3> center_lps_mm =
      std::nullopt;  ///< middle of the picture; not set: the centre of the bounding sphere
  /// Both projections show the same part of the plane through the centre. In perspective, a larger zoom
  /// therefore moves the eye closer, and finally into the volume.
  CameraProjection projection = CameraProjection::kParallel;
  double field_of_view_deg = 30;  ///< vertical angle, perspective only

  /// The camera of a standard view, at zoom 1.
  [[nodiscard]] static Camera of(NamedView view);
};

/// Size of a picture in pixels, from 1 to kMaxPictureSide on each side.
struct PictureSize {
  int width = 0, height = 0;
  friend bool operator==(const PictureSize&, const PictureSize&) = default;

  /// Index of the pixel in column x and row y, row by row.
  [[nodiscard]] constexpr std::size_t pixel(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  }
  /// Number of pixels.
  [[nodiscard]] constexpr std::size_t pixels() const { return pixel(0, height); }
};
/// Maximum width and height, for exact byte counts and fixed-point rasterisation.
inline constexpr int kMaxPictureSide = 32768;

/// Region of a picture, relative to its size: (0, 0) is its top left corner, (1, 1) its bottom right one.
struct PictureRegion {
  double left = 0, top = 0, right = 1, bottom = 1;
  friend bool operator==(const PictureRegion&, const PictureRegion&) = default;
};

/// Letters of the anatomical directions in which a unit vector in LPS points: L, R, A, P, S and I. As a
/// compass with 45 degrees between its directions: each direction at most 67.5 degrees away has a letter,
/// the nearest one first ("LA").
[[nodiscard]] std::string direction_letters(const Vec3& direction_lps);

/// Orthographic view in LPS mm. Pixel (0, 0) is at the top left, its centre at (0.5, 0.5).
struct ParallelView {
  Vec3 right_lps, up_lps, forward_lps;  ///< orthonormal; forward points away from the viewer
  Vec3 center_lps_mm;                   ///< point in the middle of the picture
  double mm_per_pixel = 1;              ///< pixel size
  PictureSize size;

  /// Maps picture coordinates (x, y) to the plane of the centre, in LPS mm.
  [[nodiscard]] Vec3 point_lps_mm(double x, double y) const;
};

/// The orthographic view of a camera; ignores its projection. kUsage for angles that are not finite, a zoom
/// outside its limits, a centre beyond kMaxMm, and a side outside [1, kMaxPictureSide]. O(1), thread-safe;
/// allocates memory for error messages only.
[[nodiscard]] Result<ParallelView> parallel_view(const Camera& camera, const PictureSize& size,
                                                 const Display& display);

/// Projection of a point onto a picture.
struct PicturePoint {
  double x = 0, y = 0;  ///< picture coordinates in pixels; pixel (0, 0) covers [0, 1) x [0, 1)
  double depth_mm = 0;  ///< distance from the plane of the centre along the view direction
};

/// View in parallel or perspective projection.
struct View {
  ParallelView plane;                           ///< view of the plane through the centre
  std::optional<double> eye_mm = std::nullopt;  ///< distance from the eye to the plane; none: parallel

  /// Unprojects picture coordinates (x, y) at `depth_mm` to LPS mm. Depth is the distance from the plane of
  /// the centre along the view direction.
  [[nodiscard]] Vec3 point_lps_mm(double x, double y, double depth_mm = 0) const;
  /// Projects a point in LPS mm: the inverse of point_lps_mm(). None for points at or behind the eye.
  [[nodiscard]] std::optional<PicturePoint> picture_point(const Vec3& point_lps_mm) const;

  /// Position of the eye, in LPS mm. Perspective only.
  [[nodiscard]] Vec3 eye_lps_mm() const;
};

/// Minimum and maximum field of view, in degrees.
inline constexpr double kMinFieldOfView = 1e-3, kMaxFieldOfView = 179;
/// Minimum distance from the eye to the centre, in mm. Prevents underflow in ray set-up.
inline constexpr double kMinEyeDistanceMm = 1e-100;

/// kUsage for a parameter of a camera. The subject is "camera: PARAMETER"; the fault begins with the value.
[[nodiscard]] tl::unexpected<Error> bad_camera(std::string_view parameter, std::string_view fault);

/// The view of a camera. kUsage as for parallel_view(). In perspective also for a field of view outside
/// [kMinFieldOfView, kMaxFieldOfView], and an eye closer than kMinEyeDistanceMm or infinitely far.
[[nodiscard]] Result<View> view_of(const Camera& camera, const PictureSize& size, const Display& display);

}  // namespace splatlas

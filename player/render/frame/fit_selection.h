// Extents of a selection in a view, and the camera whose picture they fill.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>

#include "format/content/cut_planes.h"
#include "format/content/grid.h"
#include "format/content/structure_graph.h"
#include "format/tasks/thread_pool.h"
#include "player/camera.h"
#include "player/render/decode/class_cache.h"
#include "player/render/frame/drawn_selection.h"

namespace splatlas {

/// Linear functions on points: the four planes of a view's frustum, the depth and the negative depth.
struct FitPlanes {
  static constexpr std::size_t kCount = 6;
  std::array<Vec3, kCount> gradient{};
  std::array<double, kCount> offset{};

  [[nodiscard]] double at(std::size_t n, const Vec3& p) const { return dot(gradient[n], p) + offset[n]; }
};

/// Maxima of the functions over a set of points. They do not depend on the order of insertion.
class FitExtents {
 public:
  FitExtents() { max_.fill(-std::numeric_limits<double>::infinity()); }

  [[nodiscard]] bool empty() const { return max_[0] == -std::numeric_limits<double>::infinity(); }
  [[nodiscard]] double max(std::size_t n) const { return max_[n]; }
  /// Middle and half of the length between the planes of two opposite functions.
  [[nodiscard]] double middle(std::size_t n, std::size_t opposite) const {
    return 0.5 * (max_[n] - max_[opposite]);
  }
  [[nodiscard]] double half(std::size_t n, std::size_t opposite) const {
    return 0.5 * (max_[n] + max_[opposite]);
  }

  void include(const FitPlanes& planes, const Vec3& p) {
    for (std::size_t n = 0; n < FitPlanes::kCount; ++n) max_[n] = std::max(max_[n], planes.at(n, p));
  }
  void include(const FitExtents& other) {
    for (std::size_t n = 0; n < FitPlanes::kCount; ++n) max_[n] = std::max(max_[n], other.max_[n]);
  }
  /// Replaces each point by a box around it. `reach`: half the side of the box, in the planes' coordinates.
  void grow(const FitPlanes& planes, double reach);

 private:
  std::array<double, FitPlanes::kCount> max_{};
};

/// Fit of points into a region of the picture of a camera, whose zoom and centre do not matter.
class FitFrame {
 public:
  /// Size of fitted points relative to the region. The rest is the margin.
  static constexpr double kFill = 0.96;

  /// kUsage as for view_of(), and for a region that is empty or not inside the picture.
  [[nodiscard]] static Result<FitFrame> of(const Camera& camera, const PictureSize& size,
                                           const Display& display, const PictureRegion& region = {});

  /// The camera at zoom 1, around the centre of the bounding sphere, and its view.
  [[nodiscard]] const Camera& whole() const { return camera_; }
  [[nodiscard]] const View& view() const { return view_; }
  /// The functions on points that `to_lps_mm` maps to LPS mm.
  [[nodiscard]] FitPlanes planes(const Affine& to_lps_mm) const;
  /// The camera whose region the points fill: with margins on both sides of its width, or of its height, and
  /// at least these margins on the other sides. The points are in the middle of the region, and the centre
  /// has their middle depth. All points are in front of the eye; with fields of view above 90 degrees, this
  /// can take more room than the margins. Clamps the zoom to [kMinZoom, kMaxZoom]. `extents`: not empty.
  [[nodiscard]] Camera fitted(const FitExtents& extents) const;
  /// In perspective, narrows planes() to the points. While it is true, new extents are needed: those of the
  /// sides that have room in the picture are not in its middle yet.
  [[nodiscard]] bool narrow(const FitExtents& extents);

 private:
  FitFrame(const Camera& camera, const View& view, const PictureRegion& region);
  [[nodiscard]] double fitted_half_height(const FitExtents& extents) const;

  Camera camera_;
  View view_;
  double half_height_mm_;  // of the picture in the plane of the centre, at zoom 1
  double slope_;           // half the height of the picture / distance from the eye; 0: parallel
  // Of the region without its margins, in half heights of the picture:
  double middle_right_, middle_up_;  // from the picture's middle
  double half_width_, half_height_;  // narrow() leaves those that the points take
  std::optional<double> narrowed_;   // half height in the plane of the centre, since the first narrow()
};

/// The camera. kFailed if its centre is beyond kMaxMm, as views refuse it; the message names no atlas.
[[nodiscard]] Result<Camera> within_reach(const Camera& fitted);

/// The part of a plan in some structures: classes with a membership in them, and their surfaces.
[[nodiscard]] DrawPlan part_of(const DrawPlan& plan, std::span<const StructureIndex> structures,
                               const Atlas& atlas);

/// Extents of the parts of a plan's voxels and surfaces that `cuts` keep. A voxel extends to the centres of
/// its neighbours, up to which interpolation spreads it. Empty for a plan that draws nothing. `cache` must
/// hold the plan's volume classes along `axis`, and its surfaces of the level. Cost: linear in the runs
/// within the bounding box of the plan, and in the vertices of its surfaces.
[[nodiscard]] FitExtents extents_of(const DrawPlan& plan, const Atlas& atlas, const ClassCache& cache,
                                    Axis axis, int surface_level, const CutPlanes& cuts,
                                    const FitPlanes& planes, ThreadPool& pool);

}  // namespace splatlas

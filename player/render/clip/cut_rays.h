// Clipping of rays by cutting planes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "format/content/cut_planes.h"
#include "format/content/grid.h"
#include "format/content/run_model.h"
#include "player/camera.h"
#include "player/render/view/view_frame.h"

namespace splatlas {

/// A cutting plane in continuous voxel indices: removes points with normal * index > offset.
struct VoxelPlane {
  Vec3 normal{0, 0, 1};  ///< of length 1, in voxels
  double offset = 0;     ///< in voxels

  /// Distance of a point from the plane, in voxels; positive where it is removed.
  [[nodiscard]] double distance(const Vec3& index) const { return dot(normal, index) - offset; }
};

/// The planes of a cut in the coordinates of `grid`.
[[nodiscard]] std::vector<VoxelPlane> voxel_planes(const CutPlanes& planes, const Grid& grid);

/// Interval of a ray within the kept half spaces, in units of the ray's parameter.
struct ClipInterval {
  static constexpr int kNoPlane = -1;
  double from = -std::numeric_limits<double>::infinity(), to = std::numeric_limits<double>::infinity();
  /// Index of the plane at either end; kNoPlane at the eye and at infinity.
  int front = kNoPlane, back = kNoPlane;

  [[nodiscard]] bool empty() const { return !(from < to); }
};

/// Interval of depths, in voxels along an axis of the grid; empty if from > to.
struct ClipDepths {
  double from = -std::numeric_limits<double>::infinity(), to = std::numeric_limits<double>::infinity();
};

/// Clips the rays of a view. Thread-safe. Rays are start + t * direction: t is the depth in mm in a parallel
/// view. In perspective, t is 0 at the eye and 1 in the plane through the view's centre.
class CutRays {
 public:
  /// Moves all planes by `margin` voxels into the kept part.
  CutRays(const CutPlanes& planes, const View& view, const Grid& grid, double margin = 0);

  [[nodiscard]] const std::vector<VoxelPlane>& planes() const { return planes_; }

  /// Kept part of the ray through picture coordinates (x, y).
  [[nodiscard]] ClipInterval through(double x, double y) const;
  /// The point of that ray at `t`, in continuous voxel indices.
  [[nodiscard]] double index_at(double x, double y, double t, std::size_t axis) const {
    const double on_plane = frame_.corner[axis] + x * frame_.right[axis] + y * frame_.down[axis];
    return perspective_ ? frame_.eye[axis] + t * (on_plane - frame_.eye[axis])
                        : on_plane + t * frame_.forward[axis];
  }
  [[nodiscard]] Vec3 index_at(double x, double y, double t) const {
    return {index_at(x, y, t, 0), index_at(x, y, t, 1), index_at(x, y, t, 2)};
  }
  /// Kept part of that ray in depths sign * (index along `axis`), which grow away from the viewer.
  [[nodiscard]] ClipDepths depths(double x, double y, std::size_t axis, double sign) const;

  /// Crossing of a plane by the rays of a picture row in a parallel view: t = at_zero + per_x * x.
  struct RowCrossing {
    int plane = 0;
    bool enters = false;  ///< the kept part, away from the viewer
    double at_zero = 0, per_x = 0;
  };
  /// Picture coordinates [first, last] of a row in a parallel view whose rays are not removed by planes along
  /// them, and the crossings of all other planes.
  struct Row {
    double first = 0, last = 0;
    std::vector<RowCrossing> crossings;
  };
  [[nodiscard]] bool is_parallel() const { return !perspective_; }
  [[nodiscard]] Row row(double y, double width) const;
  /// False if no ray leaves the kept part.
  [[nodiscard]] bool can_leave() const;

  /// Bit set of the planes that remove a point.
  [[nodiscard]] std::uint8_t removing(const std::array<float, 3>& index) const;

 private:
  /// Distance from a plane of the start and the direction of the ray through (x, y): affine in x and y.
  struct RayDistance {
    double start = 0, start_x = 0, start_y = 0;
    double along = 0, along_x = 0, along_y = 0;
  };

  bool perspective_;
  ViewFrame frame_;  // voxels
  std::vector<VoxelPlane> planes_;
  std::vector<RayDistance> distances_;  // of planes_
};

}  // namespace splatlas

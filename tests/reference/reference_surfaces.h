// The truth for surfaces: every triangle that a pixel's ray crosses, by looking at all of them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "format/atlas_content.h"
#include "format/selection.h"
#include "player/camera.h"

namespace splatlas::reference {

/// A ray through a triangle.
struct Crossing {
  double s_mm = 0;   ///< along the ray, as in Ray
  double depth = 0;  ///< along the principal axis in voxels, growing away from the viewer
  std::array<double, 4> rgba{0, 0, 0, 0};  ///< shaded, premultiplied, linear
  StructureIndex structure = kNoStructure;
  std::uint32_t triangle = 0;
  /// The front of the triangle is seen: its own normal, on the side that its corners' normals point to,
  /// points to the viewer. Interpolated normals are turned round where the back is seen, and only there.
  bool entering = false;
};

/// Front to back, up to the first opaque one. Where surfaces coincide (within 1/4096 voxel), those that the
/// ray leaves come first.
void put_in_order(std::vector<Crossing>& crossings);

/// Which triangles cover a pixel's centre, and how their normals are interpolated.
enum class Coverage {
  kExact,   ///< the truth
  kSnapped  ///< with vertices at multiples of 1/256 pixel, as the rasteriser has them
};

/// The selected surfaces of an atlas as one view shows them.
class SurfacesInView {
 public:
  /// Keeps a reference to `content`. `principal`: the axis that depths are counted along.
  SurfacesInView(const AtlasContent& content, const Selection& selection, const ParallelView& view,
                 Axis principal, Coverage coverage);

  /// Every crossing of the ray through picture coordinates (x, y), within the picture, front to back, up to
  /// the first opaque one. A point on an edge counts as slightly right of and below it. Where surfaces
  /// coincide, those that the ray leaves come first. Cost: all triangles of the picture's row.
  [[nodiscard]] std::vector<Crossing> crossings(double x, double y) const;

 private:
  struct Seen {
    double x = 0, y = 0;                  ///< picture coordinates
    double covered_x = 0, covered_y = 0;  ///< those that decide about coverage
    double s_mm = 0, depth = 0;
  };
  struct Surface {
    const SurfaceMesh* mesh = nullptr;
    StructureIndex structure = kNoStructure;
    std::array<double, 3> color{};
    double opacity = 1;
    std::vector<Seen> vertices;
  };
  struct TriangleRef {
    std::size_t surface = 0;
    std::uint32_t triangle = 0;
  };
  void list_rows();
  void cross(const Surface& surface, std::uint32_t triangle, double x, double y,
             std::vector<Crossing>& out) const;

  ParallelView view_;
  std::vector<Surface> surfaces_;
  std::vector<std::vector<TriangleRef>> rows_;  // of the picture: triangles that may cover a centre in it
};

}  // namespace splatlas::reference

// Brute-force surfaces of a parallel view: all triangles crossed by the ray of a pixel.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "format/content/atlas_content.h"
#include "format/content/selection.h"
#include "player/camera.h"
#include "tests/reference/ray.h"

namespace splatlas::reference {

/// Crossing of a ray and a triangle.
struct Crossing {
  double s_mm = 0;                         ///< along the ray, as in Ray
  double depth = 0;                        ///< along the principal axis in voxels, away from the viewer
  std::array<double, 4> rgba{0, 0, 0, 0};  ///< shaded, premultiplied, linear
  StructureIndex structure = kNoStructure;
  std::optional<std::uint32_t> hull = std::nullopt;  ///< of a ghost: its term
  std::uint32_t triangle = 0;
  bool entering = false;  ///< see meets_front(); interpolated normals are flipped for back faces only
};

/// True if a ray meets the front of a triangle: the geometric normal, on the side of the vertex normals,
/// points against it, or its vertex normals are ambiguous. Derived ones are counter-clockwise in front.
[[nodiscard]] bool meets_front(const SurfaceMesh& mesh, const std::array<Vec3, 3>& corners_lps,
                               const std::array<Vec3, 3>& normals_lps, const Vec3& along_lps);
/// Sets the colour of a crossing, by its structure, its side, and the weighted normals of the corners.
void shade(Crossing& crossing, const ParallelView& view, const Selection& selection,
           const std::array<Vec3, 3>& normals_lps, const std::array<double, 3>& weights);
/// Sorts front to back up to the first opaque crossing; of the crossings of a hull, only the first stays. Of
/// coincident surfaces (within 1/4096 voxel), those that the ray leaves come first.
void put_in_order(std::vector<Crossing>& crossings);

/// Rule for coverage of pixel centres and interpolation of normals.
enum class Coverage {
  kExact,   ///< exact geometry
  kSnapped  ///< vertices rounded to 1/256 pixel, as in the rasteriser
};

/// The selected surfaces of an atlas in one view.
class SurfacesInView {
 public:
  /// Keeps references to `content` and `selection`. `principal`: the axis of depths.
  SurfacesInView(const AtlasContent& content, const Selection& selection, const ParallelView& view,
                 Axis principal, Coverage coverage);

  /// All crossings of the ray through picture coordinates (x, y) within the picture, front to back up to the
  /// first opaque one. A point on an edge counts as slightly right of and below it. Of coincident surfaces,
  /// those that the ray leaves come first. `kept`: part of the ray in which they count. Cost: all triangles.
  [[nodiscard]] std::vector<Crossing> crossings(double x, double y,
                                                const RayInterval& kept = kWholeRay) const;

 private:
  struct Seen {
    double x = 0, y = 0;                  ///< picture coordinates
    double covered_x = 0, covered_y = 0;  ///< coordinates for coverage
    double s_mm = 0, depth = 0;
  };
  struct Surface {
    const SurfaceMesh* mesh = nullptr;
    StructureIndex structure = kNoStructure;
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
  const Selection& selection_;
  Affine to_lps_;
  std::vector<Surface> surfaces_;
  std::vector<std::vector<TriangleRef>> rows_;  // per picture row: triangles that may cover a centre
};

}  // namespace splatlas::reference

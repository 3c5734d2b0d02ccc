// Surfaces along any ray, in either projection, by looking at all triangles.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "format/atlas_content.h"
#include "format/selection.h"
#include "player/camera.h"
#include "tests/reference/ray.h"
#include "tests/reference/reference_surfaces.h"

namespace splatlas::reference {

/// The selected surfaces of an atlas, for rays of a view.
class RaySurfaces {
 public:
  /// Keeps a reference to `content`. Depths are counted along the principal axis of the view's middle.
  RaySurfaces(const AtlasContent& content, const Selection& selection, const View& view);

  /// Every crossing of a ray from `from_mm` on, in exact geometry (Moeller and Trumbore 1997), front to back
  /// up to the first opaque one. Where surfaces coincide, those that the ray leaves come first. Cost: all
  /// triangles.
  [[nodiscard]] std::vector<Crossing> crossings(const Ray& ray, double from_mm) const;

  /// Whether the edge of a triangle is no further from a ray than two others, beside it and below it.
  [[nodiscard]] bool near_edge(const Ray& ray, const Ray& beside, const Ray& below) const;

 private:
  struct Triangle {
    std::array<Vec3, 3> corner_ijk;
    std::array<Vec3, 3> normal_lps;
    Vec3 front_lps{};  ///< its own normal, on the side that its corners' normals point to
    StructureIndex structure = kNoStructure;
    std::uint32_t number = 0;
  };
  struct Appearance {
    std::array<double, 3> color{};
    double opacity = 1;
  };
  /// Where a ray meets the plane of a triangle.
  struct Hit {
    std::array<double, 3> weight{};  ///< of the corners
    double s_mm = 0;
  };
  [[nodiscard]] static std::optional<Hit> hit(const Triangle& triangle, const Ray& ray);
  void add(const SurfaceMesh& mesh, StructureIndex structure, const Affine& to_lps);

  ParallelView plane_;
  Matrix3 to_lps_;
  std::size_t depth_axis_;
  double depth_sign_;
  std::vector<Triangle> triangles_;
  std::vector<Appearance> appearances_;  // per structure
};

}  // namespace splatlas::reference

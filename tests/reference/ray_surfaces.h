// Brute-force ray casting of surfaces, in either projection.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "format/content/atlas_content.h"
#include "format/content/selection.h"
#include "player/camera.h"
#include "player/render/view/shear.h"
#include "tests/reference/ray.h"
#include "tests/reference/reference_surfaces.h"

namespace splatlas::reference {

/// The selected surfaces of an atlas.
class RaySurfaces {
 public:
  /// Keeps references to `content` and `selection`. Depths run along depth_axis().
  RaySurfaces(const AtlasContent& content, const Selection& selection, const View& view);

  /// All crossings of a part of a ray in exact geometry (Moeller and Trumbore 1997), front to back up
  /// to the first opaque one. Of coincident ones, those that the ray leaves come first. O(triangles).
  [[nodiscard]] std::vector<Crossing> crossings(const Ray& ray, const RayInterval& kept) const;

  /// True if an edge of a triangle is as near to a ray as two others, beside and below it.
  [[nodiscard]] bool near_edge(const Ray& ray, const Ray& beside, const Ray& below) const;

 private:
  struct Triangle {
    const SurfaceMesh* mesh = nullptr;
    std::array<Vec3, 3> corner_ijk, corner_lps, normal_lps;
    StructureIndex structure = kNoStructure;
    std::uint32_t number = 0;
  };
  /// Intersection of a ray with the plane of a triangle.
  struct Hit {
    std::array<double, 3> weight{};  ///< barycentric coordinates
    double s_mm = 0;
  };
  [[nodiscard]] static std::optional<Hit> hit(const Triangle& triangle, const Ray& ray);
  void add(const SurfaceMesh& mesh, StructureIndex structure);

  ParallelView plane_;
  const Selection& selection_;
  Affine to_lps_;
  DepthAxis depth_;  // that of the player, or any one where the player refuses the view
  std::vector<Triangle> triangles_;
};

}  // namespace splatlas::reference

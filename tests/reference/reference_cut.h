// Cutting planes and their faces in double precision.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "format/content/atlas_content.h"
#include "format/content/selection.h"
#include "player/render_options.h"
#include "tests/reference/ray.h"
#include "tests/reference/reference_radiance.h"

namespace splatlas::reference {

/// Removes points with normal * index > offset; the normal has length 1 in voxels.
struct IndexPlane {
  Vec3 normal{0, 0, 1};
  double offset = 0;

  [[nodiscard]] double distance(const Vec3& index) const { return dot(normal, index) - offset; }
};

/// Part of a ray in the kept half spaces, with the indices of the planes at its ends.
struct KeptRay {
  double from_mm = 0, to_mm = 0;
  std::optional<std::size_t> front = std::nullopt, back = std::nullopt;

  [[nodiscard]] bool empty() const { return !(from_mm < to_mm); }
};

/// A face on a ray.
struct ReferenceFace {
  std::array<double, 4> rgba{0, 0, 0, 0};  ///< premultiplied
  StructureIndex structure = kNoStructure;
};

/// The cut of a scene, by brute force. Keeps references.
class ReferenceCut {
 public:
  ReferenceCut(const AtlasContent& content, const Selection& selection, const RenderOptions& options);

  [[nodiscard]] bool empty() const { return planes_.empty(); }
  [[nodiscard]] const std::vector<IndexPlane>& planes() const { return planes_; }
  /// The part of a ray from `from_mm` on. `margin`: moves the planes into the kept part, in voxels.
  [[nodiscard]] KeptRay clip(const Ray& ray, double from_mm, double margin = 0) const;
  /// The part in which surfaces are kept: 1/4096 voxel away from the planes.
  [[nodiscard]] RayInterval surfaces(const Ray& ray, double from_mm) const;
  /// The faces at the ends of a kept part.
  [[nodiscard]] ReferenceFace front(const Ray& ray, const KeptRay& kept) const;
  [[nodiscard]] ReferenceFace back(const Ray& ray, const KeptRay& kept) const;

 private:
  [[nodiscard]] ReferenceFace face(const Vec3& index, std::size_t plane) const;
  /// The structure of a voxel's face, except for some; none for voxels without one.
  [[nodiscard]] std::optional<StructureIndex> structure_at(const Index3& voxel,
                                                           const std::vector<bool>& without) const;
  /// Share of a voxel of a structure that has a face.
  [[nodiscard]] double share_of_face(const Index3& voxel, StructureIndex s) const;
  /// By structure: those whose surfaces cross the plane in closed lines.
  [[nodiscard]] std::vector<bool> outlined(const IndexPlane& plane) const;
  /// The last outlined structure that encloses a point of the plane, by the winding number of a ray in it.
  [[nodiscard]] std::optional<StructureIndex> solid_at(const Vec3& index, const IndexPlane& plane,
                                                       const std::vector<bool>& outlined) const;
  /// True if a face of `a` hides one of `b`.
  [[nodiscard]] bool hides(StructureIndex a, StructureIndex b) const;
  [[nodiscard]] bool is_solid(StructureIndex s) const;
  [[nodiscard]] bool has_greys() const;  // and a display window
  [[nodiscard]] double grey_at(const Index3& voxel) const;

  const AtlasContent& content_;
  const Selection& selection_;
  CapMode caps_;
  Grid grid_;
  std::vector<IndexPlane> planes_;
  std::vector<StructureIndex> solids_;
  std::vector<std::vector<bool>> outlined_;  // by plane
};

}  // namespace splatlas::reference

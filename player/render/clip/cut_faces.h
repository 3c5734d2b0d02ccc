// Faces of a cut: the points where rays enter and leave its half spaces inside drawn structures.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "format/content/cut_planes.h"
#include "player/render/clip/cut_rays.h"
#include "player/render/clip/face_layer.h"
#include "player/render/clip/face_map.h"
#include "player/render/view/pixel_box.h"
#include "player/render_options.h"

namespace splatlas {

/// Faces of all planes of a cut for one selection. Immutable and thread-safe.
class CutFaces {
 public:
  /// Errors and cost as for FaceMap::build(), for each plane. Reuses the maps of `former` for planes that
  /// have not changed; `former` must be of the same selection.
  [[nodiscard]] static Result<CutFaces> build(const CutPlanes& planes, const FaceScene& scene,
                                              const CutFaces* former, ThreadPool& pool);

  [[nodiscard]] const CutPlanes& planes() const { return planes_; }
  [[nodiscard]] const FaceMap& map(int plane) const { return *maps_[static_cast<std::size_t>(plane)]; }

 private:
  CutPlanes planes_;
  std::vector<std::shared_ptr<const FaceMap>> maps_;  // of the planes
};

/// Faces of the rays of a view. Thread-safe.
class ViewFaces {
 public:
  /// References must outlive it. Depths are `depth_sign` * index along `depth_axis`, as of fragments.
  ViewFaces(const CutFaces& faces, const CutRays& rays, CapMode mode, std::size_t depth_axis,
            double depth_sign)
      : faces_(faces), rays_(rays), mode_(mode), axis_(depth_axis), sign_(depth_sign) {}

  /// The faces on the ray through picture coordinates (x, y).
  [[nodiscard]] RayFaces through(double x, double y) const;
  /// Writes the faces at the pixel centres of a row to `front` and `back`, which must be empty. `back` may be
  /// null if no ray leaves the kept part. Returns the columns that may have a face.
  FaceLayer::Extent row(std::int32_t row, std::int32_t width, Face* front, Face* back) const;
  /// False if no ray has a face at its far end.
  [[nodiscard]] bool has_back() const { return rays_.can_leave(); }

 private:
  FaceLayer::Extent row_of_parallel_rays(double y, std::int32_t width, Face* front, Face* back) const;

  const CutFaces& faces_;
  const CutRays& rays_;
  CapMode mode_;
  std::size_t axis_;
  double sign_;
};

/// Replaces the rows of a region in a layer by the faces at the pixel centres. Cost: linear in their pixels.
void fill_faces(const ViewFaces& faces, const PictureSize& size, const PixelBox& region, FaceLayer& layer,
                ThreadPool& pool);

/// Composites the faces with the pixels, which show what is between them. Cost: linear in the pixels.
void add_faces(const FaceLayer& layer, Picture& picture, ThreadPool& pool);

}  // namespace splatlas

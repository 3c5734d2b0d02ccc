#include "tests/scenes/ray_truth.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "player/surfaces/clip_triangle.h"
#include "tests/reference/perspective.h"
#include "tests/reference/reference_volume.h"

namespace splatlas {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Of the brute force: more than enough for cells of the sharpest transfer functions.
constexpr int kStepsPerVoxel = 100;

using reference::Crossing;
using reference::Ray;

bool alike(const std::vector<Crossing>& a, const std::vector<Crossing>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Crossing& x, const Crossing& y) {
    return x.structure == y.structure && x.entering == y.entering;
  });
}

}  // namespace

RayTruth::RayTruth(const RandomScene& scene, bool hybrid_shading)
    : scene_(scene),
      view_(*view_of(scene.camera, scene.options.size, scene.content.display)),
      grid_(storage_grid(scene.content)),
      nearest_mm_(view_.eye_mm ? kNearPlane * *view_.eye_mm : -kInfinity),
      surfaces_(scene.content, scene.selection, view_) {
  if (scene.options.classification == Classification::kAfter) {
    greys_.emplace(scene.content, scene.selection);
  } else {
    field_ = reference::optical_field(scene.content, scene.selection, view_.plane, hybrid_shading);
  }
}

Ray RayTruth::ray_through(double x, double y) const {
  if (!view_.eye_mm) return reference::ray_through(view_.plane, grid_, x, y);
  return reference::ray_through(reference::PerspectiveView{view_.plane, scene_.camera.field_of_view_deg},
                                grid_, x, y);
}

/// Only what is within one voxel of the grid emits or absorbs.
reference::RayRadiance RayTruth::volume(const Ray& ray, double from_mm, double to_mm) const {
  if (field_) return integrate_ray(*field_, ray, from_mm, to_mm);
  double voxels_per_mm = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    voxels_per_mm = std::max(voxels_per_mm, std::abs(ray.per_mm[a]));
    if (ray.per_mm[a] == 0) continue;
    const double one = (-1 - ray.start[a]) / ray.per_mm[a];
    const double other = (static_cast<double>(grid_.size[a]) - ray.start[a]) / ray.per_mm[a];
    from_mm = std::max(from_mm, std::min(one, other));
    to_mm = std::min(to_mm, std::max(one, other));
  }
  if (!(from_mm < to_mm)) return {};
  return greys_->along(ray, from_mm, to_mm,
                       1 + static_cast<int>(kStepsPerVoxel * voxels_per_mm * (to_mm - from_mm)));
}

std::optional<std::array<double, 4>> RayTruth::at(int column, int row) const {
  const double x = column + 0.5, y = row + 0.5;
  const Ray ray = ray_through(x, y);
  const std::vector<Crossing> crossings = surfaces_.crossings(ray, nearest_mm_);
  if (surfaces_.near_edge(ray, ray_through(x + 0.01, y), ray_through(x, y + 0.01))) return std::nullopt;
  for (const double aside : {-0.01, 0.01}) {
    for (const Ray& beside : {ray_through(x + aside, y), ray_through(x, y + aside)}) {
      if (!alike(crossings, surfaces_.crossings(beside, nearest_mm_))) return std::nullopt;
    }
  }
  reference::RayRadiance sum;
  double from_mm = view_.eye_mm ? 0 : -kInfinity;
  for (const Crossing& crossing : crossings) {
    sum.add(volume(ray, from_mm, crossing.s_mm));
    sum.add_surface(crossing.rgba);
    from_mm = std::max(from_mm, crossing.s_mm);
  }
  if (crossings.empty() || crossings.back().rgba[3] < 1) sum.add(volume(ray, from_mm, kInfinity));
  return std::array{sum.color[0], sum.color[1], sum.color[2], 1 - sum.transmittance};
}

}  // namespace splatlas

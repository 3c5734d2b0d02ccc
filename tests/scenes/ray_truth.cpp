#include "tests/scenes/ray_truth.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "player/surfaces/clip_triangle.h"
#include "tests/reference/ray.h"
#include "tests/reference/reference_volume.h"

namespace splatlas {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Resolves the sharpest transfer functions within a cell.
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
  return reference::ray_through(view_, scene_.camera.field_of_view_deg, grid_, x, y);
}

reference::RayRadiance RayTruth::volume(const Ray& ray, double from_mm, double to_mm) const {
  if (field_) return integrate_ray(*field_, ray, from_mm, to_mm);
  const reference::RayInterval part = clip_to_field(ray, grid_.size, {from_mm, to_mm});
  if (part.empty()) return {};
  double voxels_per_mm = 0;
  for (const double per_mm : ray.per_mm) voxels_per_mm = std::max(voxels_per_mm, std::abs(per_mm));
  const double steps = kStepsPerVoxel * voxels_per_mm * (part.to_mm - part.from_mm);
  return greys_->along(ray, part.from_mm, part.to_mm, 1 + static_cast<int>(steps));
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
  return sum.rgba();
}

}  // namespace splatlas

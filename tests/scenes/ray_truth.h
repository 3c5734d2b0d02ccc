// Reference ray caster for random scenes, in double precision.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "player/render/surfaces/screen_triangle.h"
#include "tests/reference/interpolated_greys.h"
#include "tests/reference/ray_surfaces.h"
#include "tests/reference/reference_cut.h"
#include "tests/reference/reference_volume.h"
#include "tests/support/random_scene.h"

namespace splatlas {

class RayTruth {
 public:
  /// Refers to `scene`. Post-classified volumes are unlit. `shares`: those of structures, not colours.
  RayTruth(const RandomScene& scene, bool hybrid_shading,
           const std::optional<reference::ShareChannels>& shares = std::nullopt)
      : scene_(scene),
        shares_(shares),
        view_(*view_of(scene.camera, scene.options.size, scene.content.display)),
        grid_(storage_grid(scene.content)),
        surfaces_(scene.content, scene.selection, view_),
        cut_(scene.content, scene.selection, scene.options) {
    if (scene.options.classification == Classification::kAfter) {
      greys_.emplace(scene.content, scene.selection, shares);
    } else {
      field_ = reference::optical_field(scene.content, scene.selection, view_.plane, hybrid_shading, shares);
    }
  }

  /// RGBA of a pixel. Nothing for an ambiguous one: a ray 0.01 pixels beside it crosses other surfaces or
  /// faces of a cut, or the same in another order.
  [[nodiscard]] std::optional<std::array<double, 4>> at(int column, int row) const {
    const double x = column + 0.5, y = row + 0.5;
    const reference::Ray ray = ray_through(x, y);
    const Crossings crossings = crossings_of(ray);
    if (surfaces_.near_edge(ray, ray_through(x + 0.01, y), ray_through(x, y + 0.01))) return std::nullopt;
    for (const double aside : {-0.01, 0.01}) {
      for (const reference::Ray& beside : {ray_through(x + aside, y), ray_through(x, y + aside)}) {
        if (!alike(crossings, crossings_of(beside)) || !same_faces(ray, beside)) return std::nullopt;
      }
    }
    reference::RayRadiance sum;
    const reference::KeptRay kept = kept_of(ray);
    if (kept.empty()) return sum.rgba();
    double from_mm = kept.from_mm;
    sum.add_surface(seen(cut_.front(ray, kept)));
    for (const reference::Crossing& crossing : crossings) {
      sum.add(volume(ray, from_mm, crossing.s_mm));
      sum.add_surface(seen(crossing));
      from_mm = std::max(from_mm, crossing.s_mm);
    }
    if (crossings.empty() || crossings.back().rgba[3] < 1) sum.add(volume(ray, from_mm, kept.to_mm));
    sum.add_surface(seen(cut_.back(ray, kept)));
    return sum.rgba();
  }

 private:
  using Crossings = std::vector<reference::Crossing>;
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();
  /// Resolves the sharpest transfer functions within a cell.
  static constexpr int kStepsPerVoxel = 100;

  template <typename Surface>
  [[nodiscard]] std::array<double, 4> seen(const Surface& surface) const {
    return shares_ ? reference::share_rgba(*shares_, surface.structure, surface.rgba[3]) : surface.rgba;
  }
  static bool alike(const Crossings& a, const Crossings& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& one, const auto& other) {
      return one.structure == other.structure && one.entering == other.entering;
    });
  }
  [[nodiscard]] reference::Ray ray_through(double x, double y) const {
    return reference::ray_through(view_, scene_.camera.field_of_view_deg, grid_, x, y);
  }
  [[nodiscard]] Crossings crossings_of(const reference::Ray& ray) const {
    return surfaces_.crossings(ray,
                               cut_.surfaces(ray, view_.eye_mm ? kNearPlane * *view_.eye_mm : -kInfinity));
  }
  [[nodiscard]] reference::KeptRay kept_of(const reference::Ray& ray) const {
    return cut_.clip(ray, view_.eye_mm ? 0 : -kInfinity);
  }
  [[nodiscard]] bool same_faces(const reference::Ray& a, const reference::Ray& b) const {
    const reference::KeptRay of_a = kept_of(a), of_b = kept_of(b);
    return of_a.empty() == of_b.empty() && of_a.front == of_b.front && of_a.back == of_b.back &&
           cut_.front(a, of_a).structure == cut_.front(b, of_b).structure &&
           cut_.back(a, of_a).structure == cut_.back(b, of_b).structure;
  }
  [[nodiscard]] reference::RayRadiance volume(const reference::Ray& ray, double from_mm, double to_mm) const {
    if (field_) return integrate_ray(*field_, ray, from_mm, to_mm);
    const reference::RayInterval part = clip_to_field(ray, grid_.size, {from_mm, to_mm});
    if (part.empty()) return {};
    double voxels_per_mm = 0;
    for (const double per_mm : ray.per_mm) voxels_per_mm = std::max(voxels_per_mm, std::abs(per_mm));
    const double steps = kStepsPerVoxel * voxels_per_mm * (part.to_mm - part.from_mm);
    return greys_->along(ray, part.from_mm, part.to_mm, 1 + static_cast<int>(steps));
  }

  const RandomScene& scene_;
  std::optional<reference::ShareChannels> shares_;
  View view_;
  Grid grid_;
  reference::RaySurfaces surfaces_;
  reference::ReferenceCut cut_;
  std::optional<reference::OpticalField> field_;
  std::optional<reference::InterpolatedGreys> greys_;
};

}  // namespace splatlas

#include "bench/smooth_field.h"

#include <array>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "tests/reference/ray.h"
#include "tests/support/test_content.h"

namespace splatlas {
namespace {

constexpr double kMaxGrey = 2;  // end of the transfer function
constexpr double kTruthStepMm = 0.05;

struct Blob {
  Vec3 center_mm;
  double width_mm;
};
constexpr std::array kBlobs{Blob{{-3, 2, -1}, 4}, Blob{{3, -3, 2}, 3.5}, Blob{{1, 4, 3}, 3},
                            Blob{{-2, -4, -4}, 3}};

/// Reach of the field: the corners of the cube.
const double kReachMm = 0.5 * std::sqrt(3.0) * kFieldSideMm;

reference::RayRadiance radiance_along(const Vec3& from_mm, const Vec3& direction, double length_mm) {
  reference::RayRadiance sum;
  const auto steps = static_cast<int>(std::ceil(length_mm / kTruthStepMm));
  const double step = length_mm / steps;
  for (int n = 0; n < steps; ++n) {
    Vec3 at{};
    for (std::size_t a = 0; a < 3; ++a) at[a] = from_mm[a] + (n + 0.5) * step * direction[a];
    const double grey = smooth_field(at);
    reference::RayRadiance slab;
    slab.transmittance = std::exp(-kFieldExtinctionPerMm * grey * step);
    const double shade = grey / kMaxGrey;
    slab.color.fill(shade * (1 - slab.transmittance));
    sum.add(slab);
  }
  return sum;
}

}  // namespace

double smooth_field(const Vec3& at_mm) {
  double sum = 0;
  for (const Blob& blob : kBlobs) {
    double squares = 0;
    for (std::size_t a = 0; a < 3; ++a)
      squares += std::pow((at_mm[a] - blob.center_mm[a]) / blob.width_mm, 2);
    sum += std::exp(-0.5 * squares);
  }
  return sum;
}

AtlasContent sampled_field(double voxel_mm) {
  const auto side = static_cast<std::int64_t>(std::lround(kFieldSideMm / voxel_mm));
  const double first = 0.5 * (voxel_mm - kFieldSideMm);
  TestVolume volume;
  volume.grid = {
      {side, side, side}, {voxel_mm, voxel_mm, voxel_mm}, {first, first, first}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};
  std::vector<float> greys;
  volume.structures = {{"field", make_mask(volume.grid.size, [&](auto i, auto j, auto k) {
                          const auto mm = [&](auto n) { return first + voxel_mm * static_cast<double>(n); };
                          greys.push_back(static_cast<float>(smooth_field({mm(i), mm(j), mm(k)})));
                          return true;
                        })}};
  volume.values = make_values(VoxelType::kFloat32, greys);
  volume.window_high = kMaxGrey;
  return make_content(volume);
}

Selection field_selection(const AtlasContent& content, double voxel_mm) {
  const double opacity = -std::expm1(-kFieldExtinctionPerMm * kMaxGrey * voxel_mm);
  return selection_of(fmt::format("field:volume(color=#ffffff,curve=0:0:0/{}:{:.12f}:1)", kMaxGrey, opacity),
                      content.graph);
}

reference::ReferencePicture field_truth(const View& view) {
  const auto [width, height] = view.plane.size;
  reference::ReferencePicture truth{view.plane.size, {}};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const Vec3 point = view.plane.point_lps_mm(x + 0.5, y + 0.5);
      Vec3 from = point;
      Vec3 direction = view.plane.forward_lps;
      double length = 2 * kReachMm;
      if (view.eye_mm) {
        from = view.eye_lps_mm();
        direction = reference::minus(point, from);
        const double to_plane = std::sqrt(reference::dot(direction, direction));
        for (double& part : direction) part /= to_plane;
        length = to_plane + kReachMm;
      } else {
        for (std::size_t a = 0; a < 3; ++a) from[a] -= kReachMm * direction[a];
      }
      truth.pixels.push_back(radiance_along(from, direction, length).rgba());
    }
  }
  return truth;
}

}  // namespace splatlas

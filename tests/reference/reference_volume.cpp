#include "tests/reference/reference_volume.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/reference/cubic.h"

namespace splatlas::reference {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kLargestDepthPerStep = 0.25;

/// Gauss-Legendre with six nodes on [0, 1]: exact for polynomials of degree 11.
struct Node {
  double at, weight;
};
constexpr std::array<Node, 6> kNodes{{{0.03376524289842399, 0.08566224618958517},
                                      {0.16939530676686774, 0.18038078652406930},
                                      {0.38069040695840155, 0.23395696728634552},
                                      {0.61930959304159845, 0.23395696728634552},
                                      {0.83060469323313226, 0.18038078652406930},
                                      {0.96623475710157601, 0.08566224618958517}}};

/// Where the ray crosses planes of voxel centres, ends included.
std::vector<double> cuts_of(const OpticalField& field, const Ray& ray, double from_mm, double to_mm) {
  for (std::size_t a = 0; a < 3; ++a) {  // nothing beyond one voxel outside the grid
    const auto last = static_cast<double>(field.grid.size[a]);
    if (ray.per_mm[a] == 0) {
      if (!(ray.start[a] > -1 && ray.start[a] < last)) return {};
      continue;
    }
    const double first_mm = (-1 - ray.start[a]) / ray.per_mm[a];
    const double last_mm = (last - ray.start[a]) / ray.per_mm[a];
    from_mm = std::max(from_mm, std::min(first_mm, last_mm));
    to_mm = std::min(to_mm, std::max(first_mm, last_mm));
  }
  if (!(from_mm < to_mm)) return {};
  std::vector<double> cuts{from_mm, to_mm};
  for (std::size_t a = 0; a < 3; ++a) {
    if (ray.per_mm[a] == 0) continue;
    for (std::int64_t plane = -1; plane <= field.grid.size[a]; ++plane) {
      const double s = (static_cast<double>(plane) - ray.start[a]) / ray.per_mm[a];
      if (s > from_mm && s < to_mm) cuts.push_back(s);
    }
  }
  std::sort(cuts.begin(), cuts.end());
  return cuts;
}

/// A piece of the ray within one cell.
RayRadiance integrate_piece(const OpticalField& field, const Ray& ray, double from_mm, double to_mm) {
  const double length_mm = to_mm - from_mm;
  std::array<VoxelOptics, 4> light;
  for (std::size_t n = 0; n < 4; ++n) {
    light[n] = field.trilinear(ray.at(from_mm + length_mm * static_cast<double>(n) / 3));
  }
  const auto cubic = [&](const auto& channel) {
    return Cubic::through(channel(light[0]), channel(light[1]), channel(light[2]), channel(light[3]));
  };
  const Cubic extinction = cubic([](const VoxelOptics& v) { return v.extinction; });
  std::array<Cubic, 3> emission{};
  for (std::size_t c = 0; c < 3; ++c)
    emission[c] = cubic([c](const VoxelOptics& v) { return v.emission[c]; });

  const double most =
      std::max({light[0].extinction, light[1].extinction, light[2].extinction, light[3].extinction});
  if (most == 0) return {};  // a cubic that is zero at four points
  const int steps = 1 + static_cast<int>(most * length_mm / kLargestDepthPerStep);
  RayRadiance sum;
  for (int step = 0; step < steps; ++step) {
    for (const Node& node : kNodes) {
      const double t = (step + node.at) / steps;
      const double weight = length_mm * node.weight / steps * std::exp(-length_mm * extinction.integral(t));
      for (std::size_t c = 0; c < 3; ++c) sum.color[c] += weight * emission[c](t);
    }
  }
  sum.transmittance = std::exp(-length_mm * extinction.integral(1));
  return sum;
}

}  // namespace

RayRadiance integrate_ray(const OpticalField& field, const Ray& ray, double from_mm, double to_mm) {
  RayRadiance sum;
  const std::vector<double> cuts = cuts_of(field, ray, from_mm, to_mm);
  for (std::size_t n = 1; n < cuts.size(); ++n) {
    if (cuts[n] > cuts[n - 1]) sum.add(integrate_piece(field, ray, cuts[n - 1], cuts[n]));
  }
  return sum;
}

RayRadiance integrate_ray(const OpticalField& field, const Ray& ray) {
  return integrate_ray(field, ray, -kInfinity, kInfinity);
}

}  // namespace splatlas::reference

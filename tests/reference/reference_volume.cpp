#include "tests/reference/reference_volume.h"

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "tests/reference/cubic.h"

namespace splatlas::reference {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Gauss-Legendre quadrature with six nodes on [0, 1], exact for polynomials of degree 11.
constexpr std::array<Node, 6> kNodes{{{0.03376524289842399, 0.08566224618958517},
                                      {0.16939530676686774, 0.18038078652406930},
                                      {0.38069040695840155, 0.23395696728634552},
                                      {0.61930959304159845, 0.23395696728634552},
                                      {0.83060469323313226, 0.18038078652406930},
                                      {0.96623475710157601, 0.08566224618958517}}};

/// Crossings of the ray with planes of voxel centres, and both ends.
std::vector<double> cuts_of(const OpticalField& field, const Ray& ray, double from_mm, double to_mm) {
  const RayInterval interval = clip_to_field(ray, field.grid.size, {from_mm, to_mm});
  if (interval.empty()) return {};
  std::vector<double> cuts{interval.from_mm, interval.to_mm};
  for (std::size_t a = 0; a < 3; ++a) {
    if (ray.per_mm[a] == 0) continue;
    for (std::int64_t plane = -1; plane <= field.grid.size[a]; ++plane) {
      const double s = (static_cast<double>(plane) - ray.start[a]) / ray.per_mm[a];
      if (s > interval.from_mm && s < interval.to_mm) cuts.push_back(s);
    }
  }
  std::sort(cuts.begin(), cuts.end());
  return cuts;
}

/// A ray segment within one cell.
RayRadiance integrate_piece(const OpticalField& field, const Ray& ray, double from_mm, double to_mm) {
  const double length_mm = to_mm - from_mm;
  std::array<VoxelOptics, 4> optics;
  for (std::size_t n = 0; n < 4; ++n) {
    optics[n] = field.trilinear(ray.at(from_mm + length_mm * static_cast<double>(n) / 3));
  }
  const auto cubic = [&](const auto& channel) {
    return Cubic::through(channel(optics[0]), channel(optics[1]), channel(optics[2]), channel(optics[3]));
  };
  const Cubic extinction = cubic([](const VoxelOptics& v) { return v.extinction; });
  std::array<Cubic, 3> emission{};
  for (std::size_t c = 0; c < 3; ++c)
    emission[c] = cubic([c](const VoxelOptics& v) { return v.emission[c]; });

  const auto emitted = [&](double t) { return std::array{emission[0](t), emission[1](t), emission[2](t)}; };
  return integrate(kNodes, extinction, emitted, 0, 1, length_mm);
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

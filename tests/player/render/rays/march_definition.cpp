#include "tests/player/render/rays/march_definition.h"

#include <algorithm>
#include <cmath>

#include "tests/reference/optical_field.h"

namespace splatlas::reference {
namespace {

/// A ray, clipped to one voxel around the selected voxels.
struct Ray {
  std::array<float, 3> origin{}, step{};
  double mm_per_t = 0;
  float from = 0, to = 0;

  Ray(const MarchGrid& grid, const RayPacket& packet, std::size_t n)
      : mm_per_t(packet.mm_per_t[n]), from(packet.from[n]), to(packet.to[n]) {
    for (std::size_t a = 0; a < 3; ++a) {
      origin[a] = packet.origin[a][n];
      step[a] = packet.step[a][n];
      const float inverse = 1 / (std::abs(step[a]) < 1e-20f ? 1e-20f : step[a]);
      const float low = (1 - origin[a]) * inverse;
      const float high = (static_cast<float>(grid.size[a] - 2) - origin[a]) * inverse;
      from = std::max(from, std::min(low, high));
      to = std::min(to, std::max(low, high));
    }
  }
};

/// A point of a ray, in single precision as in the kernels.
struct Sample {
  const MarchGrid& grid;
  Vec3 index{};

  Sample(const MarchGrid& march_grid, const Ray& ray, float t) : grid(march_grid) {
    for (std::size_t a = 0; a < 3; ++a) index[a] = std::fma(ray.step[a], t, ray.origin[a]);
  }

  /// The trilinear mean of `value(voxel)`.
  template <typename Value>
  [[nodiscard]] double mean(const Value& value) const {
    double sum = 0;
    for_each_corner(index, [&](const Index3& corner, double weight) {
      sum += weight * value((corner[2] * grid.size[1] + corner[1]) * grid.size[0] + corner[0]);
    });
    return sum;
  }
  [[nodiscard]] double grey(const MarchSource& source) const {
    return mean([&](std::ptrdiff_t voxel) {
      // The first corner of a voxel's own cell is the voxel.
      return source.cell_corners != nullptr ? static_cast<double>(source.cell_corners[voxel] & 255)
                                            : static_cast<double>(source.greys[voxel]);
    });
  }
  [[nodiscard]] std::array<double, 4> fours(const float* values) const {
    std::array<double, 4> means{};
    for (std::ptrdiff_t c = 0; c < 4; ++c) {
      means[static_cast<std::size_t>(c)] =
          mean([&](std::ptrdiff_t voxel) { return static_cast<double>(values[4 * voxel + c]); });
    }
    return means;
  }
};

/// A transfer function as linear pieces.
class Pieces {
 public:
  explicit Pieces(const PreintegratedTransfer& transfer) : transfer_(transfer) {}

  struct Optics {
    double extinction = 0, emission = 0;  // emission: extinction * shade
  };
  [[nodiscard]] Optics at(double grey) const { return in_piece(piece_of(grey), grey); }

  /// Means over the grey values from a to b: the products are polynomials of degree two in each piece, for
  /// which Simpson's rule is exact.
  [[nodiscard]] Optics mean(double a, double b) const {
    const std::size_t first = piece_of(std::min(a, b)), last = piece_of(std::max(a, b));
    if (first == last || std::abs(b - a) <= static_cast<double>(transfer_.min_difference())) {
      return same_piece(at(a), at(b), a, b);
    }
    Optics sum;
    double begin = std::min(a, b);
    for (std::size_t piece = first; piece <= last; ++piece) {
      const double end = piece == last ? std::max(a, b) : value(PreintegratedTransfer::kGrey, piece + 1);
      const Optics low = in_piece(piece, begin), high = in_piece(piece, end),
                   middle = in_piece(piece, (begin + end) / 2);
      sum.extinction += (end - begin) / 6 * (low.extinction + 4 * middle.extinction + high.extinction);
      sum.emission += (end - begin) / 6 * (low.emission + 4 * middle.emission + high.emission);
      begin = end;
    }
    return {sum.extinction / std::abs(b - a), sum.emission / std::abs(b - a)};
  }

 private:
  [[nodiscard]] double value(PreintegratedTransfer::Row row, std::size_t piece) const {
    return static_cast<double>(transfer_.row(row)[piece]);
  }
  /// The number of points that are not above a grey value.
  [[nodiscard]] std::size_t piece_of(double grey) const {
    std::size_t piece = 0;
    while (piece < transfer_.points() && grey >= value(PreintegratedTransfer::kGrey, piece + 1)) ++piece;
    return piece;
  }
  [[nodiscard]] Optics in_piece(std::size_t piece, double grey) const {
    const double above = grey - value(PreintegratedTransfer::kGrey, piece);
    const double extinction = value(PreintegratedTransfer::kExtinction, piece) +
                              value(PreintegratedTransfer::kExtinctionSlope, piece) * above;
    const double shade = value(PreintegratedTransfer::kShade, piece) +
                         value(PreintegratedTransfer::kShadeSlope, piece) * above;
    return {std::max(extinction, 0.0), std::max(extinction, 0.0) * shade};
  }
  /// Extinction and shade change linearly from a to b.
  [[nodiscard]] Optics same_piece(const Optics& from, const Optics& to, double a, double b) const {
    const double shade_a = shade(a), shade_b = shade(b);
    return {(from.extinction + to.extinction) / 2,
            (from.extinction * (2 * shade_a + shade_b) + to.extinction * (2 * shade_b + shade_a)) / 6};
  }
  [[nodiscard]] double shade(double grey) const {
    const std::size_t piece = piece_of(grey);
    return value(PreintegratedTransfer::kShade, piece) +
           value(PreintegratedTransfer::kShadeSlope, piece) *
               (grey - value(PreintegratedTransfer::kGrey, piece));
  }

  const PreintegratedTransfer& transfer_;
};

/// Extinction, and emission in red, green and blue.
using Optics = std::array<double, 4>;

/// A ray segment: means over it, and both ends.
struct Segment {
  Optics mean{}, before{}, after{};

  void add(const MarchSource& source, const Sample& from, const Sample& to, const Sample& middle) {
    if (source.optics != nullptr) {
      const Optics a = from.fours(source.optics), b = to.fours(source.optics);
      for (std::size_t c = 0; c < 4; ++c) {
        mean[c] += (a[c] + b[c]) / 2;
        before[c] += a[c];
        after[c] += b[c];
      }
      return;
    }
    const Pieces pieces(*source.transfer);
    const double a = from.grey(source), b = to.grey(source);
    std::array<double, 4> color{source.color[0], source.color[1], source.color[2], 1};
    if (source.colors != nullptr) color = middle.fours(source.colors);
    const auto add_to = [&](const Pieces::Optics& optics, Optics& sum) {
      sum[0] += optics.extinction;
      for (std::size_t c = 0; c < 3; ++c)
        sum[c + 1] += optics.emission * color[c] / std::max(color[3], 1e-12);
    };
    const Pieces::Optics over = pieces.mean(a, b);
    if (over.extinction <= 0) return;
    add_to(over, mean);
    add_to(pieces.at(a), before);
    add_to(pieces.at(b), after);
  }

  /// Composites the segment behind `rgba`. The colour is linear in the share q of the optical depth tau, with
  /// the mean that the emission has and the slope that the ends have: the integral of colour(q) tau exp(-tau
  /// q).
  void composite(double length, std::array<double, 4>& rgba) const {
    const double depth = mean[0] * length;
    if (depth <= 0) return;
    const double transmittance = 1 - rgba[3];
    const double opacity = -std::expm1(-depth);
    const double offset = opacity / depth - 1 + opacity / 2;
    const double ends = std::max(before[0] + after[0], static_cast<double>(1e-3f) * mean[0]);
    for (std::size_t c = 0; c < 3; ++c) {
      const double color = mean[c + 1] / mean[0];
      const double rise = (after[c + 1] - after[0] * color) - (before[c + 1] - before[0] * color);
      const double radiance = opacity * color + 2 * rise / ends * offset;
      rgba[c] += transmittance * std::clamp(radiance, 0.0, opacity * std::max(color, 1.0));
    }
    rgba[3] += transmittance * opacity;
  }
};

}  // namespace

std::array<double, 4> march_definition(const MarchScene& scene, const RayPacket& rays, std::size_t n,
                                       std::array<double, 4> rgba) {
  const Ray ray(scene.grid, rays, n);
  float begin = ray.from;
  for (float slab = std::floor(ray.from); begin < ray.to; ++slab) {
    const float end = std::min(std::max(slab + 1, ray.from), ray.to);
    float at = begin;
    for (int step = 1; step <= scene.min_steps && begin < end; ++step) {
      const float part = static_cast<float>(step) / static_cast<float>(scene.min_steps);
      const float next = step == scene.min_steps ? end : std::fma(part, end - begin, begin);
      const Sample from(scene.grid, ray, at), to(scene.grid, ray, next);
      const Sample middle(scene.grid, ray, 0.5f * (at + next));
      Segment segment;
      for (const MarchSource& source : scene.sources) segment.add(source, from, to, middle);
      segment.composite(ray.mm_per_t * static_cast<double>(next - at), rgba);
      at = next;
    }
    begin = end;
  }
  return rgba;
}

}  // namespace splatlas::reference

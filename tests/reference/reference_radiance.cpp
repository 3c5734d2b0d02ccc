#include "tests/reference/reference_radiance.h"

#include <algorithm>
#include <cmath>

#include "tests/reference/ray.h"

namespace splatlas::reference {
namespace {

constexpr double kAmbient = 0.15;
constexpr double kHighlight = 0.10;
constexpr double kHighlightPower = 32;

double linear_of(std::uint8_t channel) {
  const double encoded = channel / 255.0;
  return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

Vec3 unit(const Vec3& v) {
  const double length = std::sqrt(dot(v, v));
  return {v[0] / length, v[1] / length, v[2] / length};
}

Vec3 to_viewer(const ParallelView& view) {
  return minus({0, 0, 0}, view.forward_lps);
}
Vec3 to_light(const ParallelView& view) {
  Vec3 light = to_viewer(view);
  for (std::size_t a = 0; a < 3; ++a) light[a] += -0.45 * view.right_lps[a] + 0.55 * view.up_lps[a];
  return unit(light);
}

}  // namespace

std::array<double, 3> linear_of(Rgb color) {
  return {linear_of(color.r), linear_of(color.g), linear_of(color.b)};
}

TransferValue transfer(const TransferCurve& curve, double grey, double reference_length_mm) {
  const auto at = [&](const TransferPoint& point) {
    const double depth = -std::log1p(-static_cast<double>(point.opacity));
    return TransferValue{depth / reference_length_mm, point.shade};
  };
  std::size_t reached = 0;  // points at or below the grey value
  while (reached < curve.points.size() && grey >= curve.points[reached].grey) ++reached;
  if (reached == 0) return at(curve.points.front());
  const TransferPoint& low = curve.points[reached - 1];
  if (reached == curve.points.size()) return at(low);
  const TransferPoint& high = curve.points[reached];
  const double of_high = (grey - low.grey) / (high.grey - low.grey);
  const double of_low = (high.grey - grey) / (high.grey - low.grey);
  return {of_low * at(low).extinction_per_mm + of_high * at(high).extinction_per_mm,
          of_low * at(low).shade + of_high * at(high).shade};
}

namespace {

double one_sided(const ParallelView& view, const Vec3& normal_lps) {
  const Vec3 light = to_light(view);
  const double length = std::sqrt(dot(normal_lps, normal_lps));
  const double facing = length > 0 ? dot(normal_lps, light) / length : dot(to_viewer(view), light);
  return kAmbient + (1 - kAmbient) * std::max(0.0, facing);
}

}  // namespace

double diffuse(const ParallelView& view, const Vec3& normal_lps) {
  const Vec3 viewer = to_viewer(view);
  const double away = std::min(0.0, dot(normal_lps, viewer));
  Vec3 mirrored = normal_lps;  // at the plane of the picture
  for (std::size_t a = 0; a < 3; ++a) mirrored[a] -= 2 * away * viewer[a];
  return one_sided(view, mirrored);
}

std::array<double, 3> shade_surface(const ParallelView& view, const std::array<double, 3>& color,
                                    const Vec3& normal_lps) {
  const Vec3 viewer = to_viewer(view);
  const Vec3 light = to_light(view);
  const Vec3 half = unit({viewer[0] + light[0], viewer[1] + light[1], viewer[2] + light[2]});
  const double length = std::sqrt(dot(normal_lps, normal_lps));
  const double toward_half = length > 0 ? std::max(0.0, dot(normal_lps, half)) / length : 0;
  const double highlight = kHighlight * std::pow(toward_half, kHighlightPower);
  std::array<double, 3> shaded{};
  for (std::size_t c = 0; c < 3; ++c) {
    shaded[c] = std::min(1.0, color[c] * one_sided(view, normal_lps) + highlight);
  }
  return shaded;
}

void RayRadiance::add(const RayRadiance& further) {
  for (std::size_t c = 0; c < 3; ++c) color[c] += transmittance * further.color[c];
  transmittance *= further.transmittance;
}

void RayRadiance::add_weighted(double weight, const RayRadiance& other) {
  for (std::size_t c = 0; c < 3; ++c) color[c] += weight * other.color[c];
  transmittance += weight * other.transmittance;
}

void RayRadiance::add_surface(const std::array<double, 4>& premultiplied) {
  add({{premultiplied[0], premultiplied[1], premultiplied[2]}, 1 - premultiplied[3]});
}

}  // namespace splatlas::reference

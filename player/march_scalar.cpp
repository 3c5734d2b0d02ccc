#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "player/march_kernels.h"

namespace splatlas {
namespace {

using Weights = std::array<float, 8>;

/// A ray of a packet.
struct LoneRay {
  std::array<float, 3> origin{}, step{};
  float mm_per_t = 0, from = 0, to = 0;

  LoneRay(const RayPacket& packet, std::size_t n)
      : mm_per_t(packet.mm_per_t[n]), from(packet.from[n]), to(packet.to[n]) {
    for (std::size_t a = 0; a < 3; ++a) {
      origin[a] = packet.origin[a][n];
      step[a] = packet.step[a][n];
    }
  }
};

/// A cell, and where in it.
struct Place {
  std::array<std::ptrdiff_t, 8> corner{};  // numbers of the voxels around it
  Weights weights{};

  Place(const MarchGrid& grid, const LoneRay& ray, float t) {
    std::array<std::ptrdiff_t, 3> whole{};
    std::array<float, 3> part{};
    for (std::size_t a = 0; a < 3; ++a) {
      const float at = std::fma(ray.step[a], t, ray.origin[a]);  // a whole voxel of margin is for rounding
      whole[a] = static_cast<std::ptrdiff_t>(at);
      part[a] = at - static_cast<float>(whole[a]);
    }
    const std::array<std::ptrdiff_t, 3> stride{1, grid.size[0],
                                               static_cast<std::ptrdiff_t>(grid.size[0]) * grid.size[1]};
    for (std::size_t n = 0; n < 8; ++n) {
      corner[n] = 0;
      weights[n] = 1;
      for (std::size_t a = 0; a < 3; ++a) {
        const bool high = (n >> a & 1) != 0;
        corner[n] += (whole[a] + (high ? 1 : 0)) * stride[a];
        weights[n] *= high ? part[a] : 1 - part[a];
      }
    }
  }

  [[nodiscard]] std::array<float, 4> fours(const float* values) const {
    std::array<float, 4> sum{};
    for (std::size_t n = 0; n < 8; ++n) {
      for (std::size_t c = 0; c < 4; ++c) sum[c] += weights[n] * values[4 * corner[n] + static_cast<int>(c)];
    }
    return sum;
  }
  /// The grey value between voxels, and the lowest and the highest of the eight around.
  [[nodiscard]] std::array<float, 3> grey(const MarchSource& source) const {
    float sum = 0, low = std::numeric_limits<float>::max(), high = -low;
    for (std::size_t n = 0; n < 8; ++n) {
      const float voxel = source.octants != nullptr
                              ? static_cast<float>(source.octants[corner[0]] >> (8 * n) & 255)
                              : source.greys[corner[n]];
      sum += weights[n] * voxel;
      low = std::min(low, voxel);
      high = std::max(high, voxel);
    }
    return {sum, low, high};
  }
};

struct Classified {
  float grey = 0, extinction = 0, shade = 0;
  std::size_t segment = 0;
};

Classified classify(const GreyCurve& curve, float grey) {
  const float* greys = curve.row(GreyCurve::kGrey);
  Classified c;
  c.grey = grey;
  while (c.segment < curve.points() && grey >= greys[c.segment + 1]) ++c.segment;
  const float above = grey - greys[c.segment];
  c.extinction = std::max(0.0f, curve.row(GreyCurve::kExtinctionSlope)[c.segment] * above +
                                    curve.row(GreyCurve::kExtinction)[c.segment]);
  c.shade = curve.row(GreyCurve::kShadeSlope)[c.segment] * above + curve.row(GreyCurve::kShade)[c.segment];
  return c;
}

/// Integrals of a curve up to a grey value: of the extinction, and of extinction times shade.
std::array<float, 2> integrals(const GreyCurve& curve, const Classified& c) {
  const auto value = [&](GreyCurve::Row row) { return curve.row(row)[c.segment]; };
  const float above = c.grey - value(GreyCurve::kGrey);
  const float k = value(GreyCurve::kExtinction), k_slope = value(GreyCurve::kExtinctionSlope);
  const float s = value(GreyCurve::kShade), s_slope = value(GreyCurve::kShadeSlope);
  const float linear = 0.5f * (k * s_slope + k_slope * s);
  return {value(GreyCurve::kDepth) + above * (k + 0.5f * k_slope * above),
          value(GreyCurve::kEmission) + above * (k * s + above * (linear + above * k_slope * s_slope / 3))};
}

/// Means of extinction, and of extinction times shade, over the grey values from a to b.
std::array<float, 2> means(const GreyCurve& curve, const Classified& a, const Classified& b) {
  const float difference = b.grey - a.grey;
  if (a.segment == b.segment || std::abs(difference) <= curve.least_difference()) {
    return {0.5f * (a.extinction + b.extinction),
            (a.extinction * (2 * a.shade + b.shade) + b.extinction * (2 * b.shade + a.shade)) / 6};
  }
  const std::array<float, 2> to_a = integrals(curve, a), to_b = integrals(curve, b);
  const float extinction = std::max(0.0f, (to_b[0] - to_a[0]) / difference);
  return {extinction, std::clamp((to_b[1] - to_a[1]) / difference, 0.0f, extinction)};
}

/// What the extinction rises and falls by up to a grey value.
float variation(const GreyCurve& curve, float grey) {
  const Classified c = classify(curve, grey);
  return curve.row(GreyCurve::kVariationSlope)[c.segment] * (grey - curve.row(GreyCurve::kGrey)[c.segment]) +
         curve.row(GreyCurve::kVariation)[c.segment];
}

/// One source's sample.
struct Sampled {
  Classified classified;         // of grey values
  float low = 0, high = 0;       // of the voxels around: greys, or extinction
  std::array<float, 4> light{};  // of light

  Sampled(const MarchSource& source, const Place& place) {
    if (source.light != nullptr) {
      light = place.fours(source.light);
      low = high = source.light[4 * place.corner[0]];
      for (const std::ptrdiff_t voxel : place.corner) {
        low = std::min(low, source.light[4 * voxel]);
        high = std::max(high, source.light[4 * voxel]);
      }
      return;
    }
    const auto [grey, lowest, highest] = place.grey(source);
    classified = classify(*source.curve, grey);
    low = lowest;
    high = highest;
  }
};

using Samples = std::vector<Sampled>;  // by source

Samples sample(const MarchScene& scene, const LoneRay& ray, float t) {
  const Place place(scene.grid, ray, t);
  Samples samples;
  for (const MarchSource& source : scene.sources) samples.emplace_back(source, place);
  return samples;
}

/// Extinction, and emission in red, green and blue, of one source from `before` to `after`.
std::array<float, 4> light_between(const MarchSource& source, const Sampled& before, const Sampled& after,
                                   const Place& middle) {
  std::array<float, 4> light{};
  if (source.light != nullptr) {
    for (std::size_t c = 0; c < 4; ++c) light[c] = 0.5f * (before.light[c] + after.light[c]);
    return light;
  }
  const auto [extinction, emission] = means(*source.curve, before.classified, after.classified);
  if (extinction <= 0) return light;
  light[0] = extinction;
  std::array<float, 4> color{source.color[0], source.color[1], source.color[2], 1};
  if (source.colors != nullptr) color = middle.fours(source.colors);
  const float share = emission / std::max(color[3], 1e-12f);
  for (std::size_t c = 0; c < 3; ++c) light[c + 1] = share * color[c];
  return light;
}

int steps_of(const MarchScene& scene, const Samples& before, const Samples& after, float weight) {
  if (scene.tolerance <= 0) return scene.least_steps;
  float varies = 0;
  for (std::size_t s = 0; s < scene.sources.size(); ++s) {
    const MarchSource& source = scene.sources[s];
    const float low = std::min(before[s].low, after[s].low);
    const float high = std::max(before[s].high, after[s].high);
    varies +=
        source.light != nullptr ? high - low : variation(*source.curve, high) - variation(*source.curve, low);
  }
  const float most = weight * varies / scene.tolerance;
  const float steps = std::ceil(std::cbrt(most * most));
  return static_cast<int>(
      std::clamp(steps, static_cast<float>(scene.least_steps), static_cast<float>(scene.most_steps)));
}

/// Composites the way between two samples.
void step(const MarchScene& scene, const LoneRay& ray, const Samples& before, const Samples& after, float at,
          float next, std::array<float, 4>& rgba) {
  const Place middle(scene.grid, ray, 0.5f * (at + next));
  std::array<float, 4> light{};
  for (std::size_t s = 0; s < scene.sources.size(); ++s) {
    const std::array<float, 4> more = light_between(scene.sources[s], before[s], after[s], middle);
    for (std::size_t c = 0; c < 4; ++c) light[c] += more[c];
  }
  const float length = ray.mm_per_t * (next - at);
  const float depth = light[0] * length;
  if (depth <= 0) return;
  const float through = 1 - rgba[3];
  const float absorbed = -std::expm1(-depth);
  for (std::size_t c = 0; c < 3; ++c) rgba[c] += through * length * (absorbed / depth) * light[c + 1];
  rgba[3] += through * absorbed;
}

/// As far as the ray is within one voxel of the voxels; false where it never is.
bool clip(const MarchGrid& grid, LoneRay& ray) {
  for (std::size_t a = 0; a < 3; ++a) {
    const float per_t = std::abs(ray.step[a]) < 1e-20f ? 1e-20f : ray.step[a];
    const float low = (1 - ray.origin[a]) / per_t;
    const float high = (static_cast<float>(grid.size[a]) - 2 - ray.origin[a]) / per_t;
    ray.from = std::max(ray.from, std::min(low, high));
    ray.to = std::min(ray.to, std::max(low, high));
  }
  return ray.from < ray.to;
}

void march_ray(const MarchScene& scene, LoneRay ray, std::array<float, 4>& rgba) {
  if (!clip(scene.grid, ray)) return;
  const auto clamped = [&](float t) { return std::min(std::max(t, ray.from), ray.to); };
  Samples before = sample(scene, ray, ray.from);
  float at = ray.from;
  for (float slab = std::floor(ray.from); at < ray.to && 1 - rgba[3] > scene.floor; ++slab) {
    const float end = clamped(slab + 1);
    const Samples last = sample(scene, ray, end);
    const int steps = steps_of(scene, before, last, (1 - rgba[3]) * ray.mm_per_t * (end - at));
    for (int n = 1; n <= steps; ++n) {
      const float next = n == steps ? end : clamped(slab + static_cast<float>(n) / static_cast<float>(steps));
      const Samples after = n == steps ? last : sample(scene, ray, next);
      step(scene, ray, before, after, at, next, rgba);
      before = after;
      at = next;
    }
  }
}

void march(const MarchScene& scene, const RayPacket& rays, LightPacket& light) {
  for (std::size_t n = 0; n < kPacketRays; ++n) {
    std::array<float, 4> rgba{};
    for (std::size_t c = 0; c < 4; ++c) rgba[c] = light.planes[c][n];
    march_ray(scene, LoneRay(rays, n), rgba);
    for (std::size_t c = 0; c < 4; ++c) light.planes[c][n] = rgba[c];
  }
}

}  // namespace

const MarchKernels& scalar_march() {
  static constexpr MarchKernels kKernels{"scalar", march};
  return kKernels;
}

}  // namespace splatlas

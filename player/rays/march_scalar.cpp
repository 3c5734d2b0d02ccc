#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "player/rays/march_kernels.h"
#include "player/rays/march_tolerance.h"

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
  std::array<float, 3> part{};
  Weights weights{};

  Place(const MarchGrid& grid, const LoneRay& ray, float t) {
    std::array<std::ptrdiff_t, 3> whole{};
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
  /// The grey value between voxels.
  [[nodiscard]] float grey(const MarchSource& source) const {
    float sum = 0;
    for (std::size_t n = 0; n < 8; ++n) {
      const float voxel = source.cell_corners != nullptr
                              ? static_cast<float>(source.cell_corners[corner[0]] >> (8 * n) & 255)
                              : source.greys[corner[n]];
      sum += weights[n] * voxel;
    }
    return sum;
  }
};

struct Classified {
  float grey = 0, extinction = 0, shade = 0;
  std::size_t segment = 0;
};

Classified classify(const PreintegratedTransfer& curve, float grey) {
  const float* greys = curve.row(PreintegratedTransfer::kGrey);
  Classified c;
  c.grey = grey;
  while (c.segment < curve.points() && grey >= greys[c.segment + 1]) ++c.segment;
  const float above = grey - greys[c.segment];
  c.extinction = std::max(0.0f, curve.row(PreintegratedTransfer::kExtinctionSlope)[c.segment] * above +
                                    curve.row(PreintegratedTransfer::kExtinction)[c.segment]);
  c.shade = curve.row(PreintegratedTransfer::kShadeSlope)[c.segment] * above +
            curve.row(PreintegratedTransfer::kShade)[c.segment];
  return c;
}

/// Integrals of a curve up to a grey value: of the extinction, and of extinction times shade.
std::array<float, 2> integrals(const PreintegratedTransfer& curve, const Classified& c) {
  const auto value = [&](PreintegratedTransfer::Row row) { return curve.row(row)[c.segment]; };
  const float above = c.grey - value(PreintegratedTransfer::kGrey);
  const float k = value(PreintegratedTransfer::kExtinction),
              k_slope = value(PreintegratedTransfer::kExtinctionSlope);
  const float s = value(PreintegratedTransfer::kShade), s_slope = value(PreintegratedTransfer::kShadeSlope);
  const float linear = 0.5f * (k * s_slope + k_slope * s);
  return {value(PreintegratedTransfer::kDepth) + above * (k + 0.5f * k_slope * above),
          value(PreintegratedTransfer::kEmission) +
              above * (k * s + above * (linear + above * k_slope * s_slope / 3))};
}

/// Means of extinction, and of extinction times shade, over the grey values from a to b.
std::array<float, 2> means(const PreintegratedTransfer& curve, const Classified& a, const Classified& b) {
  const float difference = b.grey - a.grey;
  if (a.segment == b.segment || std::abs(difference) <= curve.min_difference()) {
    return {0.5f * (a.extinction + b.extinction),
            (a.extinction * (2 * a.shade + b.shade) + b.extinction * (2 * b.shade + a.shade)) / 6};
  }
  const std::array<float, 2> to_a = integrals(curve, a), to_b = integrals(curve, b);
  const float extinction = std::max(0.0f, (to_b[0] - to_a[0]) / difference);
  return {extinction, std::clamp((to_b[1] - to_a[1]) / difference, 0.0f, extinction)};
}

/// Means where the grey value is `bend` above a straight line from a to b in the mean: to first order.
std::array<float, 2> bent(const PreintegratedTransfer& curve, const Classified& a, const Classified& b,
                          const std::array<float, 2>& straight, float bend) {
  const float difference = b.grey - a.grey;
  const float shade = 0.5f * (a.shade + b.shade);
  float k_slope = curve.row(PreintegratedTransfer::kExtinctionSlope)[a.segment];
  float e_slope = straight[0] * curve.row(PreintegratedTransfer::kShadeSlope)[a.segment] + k_slope * shade;
  if (a.segment != b.segment) {
    if (std::abs(difference) <= curve.min_difference()) return straight;
    k_slope = (b.extinction - a.extinction) / difference;
    e_slope = (b.extinction * b.shade - a.extinction * a.shade) / difference;
    const float most = 0.5f * std::abs(difference);
    bend = std::clamp(bend, -most, most);
  }
  const float extinction = std::max(0.0f, straight[0] + k_slope * bend);
  return {extinction, std::clamp(straight[1] + e_slope * bend, 0.0f, extinction)};
}

/// What the extinction rises and falls by up to a grey value.
float variation(const PreintegratedTransfer& curve, float grey) {
  const Classified c = classify(curve, grey);
  return curve.row(PreintegratedTransfer::kVariationSlope)[c.segment] *
             (grey - curve.row(PreintegratedTransfer::kGrey)[c.segment]) +
         curve.row(PreintegratedTransfer::kVariation)[c.segment];
}

/// The lowest and the highest of the voxels around all cells that a ray passes from `at` to `end`, a slab
/// apart at most: of those of the box around them.
std::array<float, 2> range_between(const MarchGrid& grid, const MarchSource& source, const LoneRay& ray,
                                   float at, float end) {
  std::array<std::ptrdiff_t, 3> first{}, last{};
  for (std::size_t a = 0; a < 3; ++a) {
    const float from = std::fma(ray.step[a], at, ray.origin[a]),
                to = std::fma(ray.step[a], end, ray.origin[a]);
    first[a] = static_cast<std::ptrdiff_t>(std::min(from, to));
    last[a] = static_cast<std::ptrdiff_t>(std::max(from, to)) + 1;
  }
  float low = std::numeric_limits<float>::max(), high = -low;
  for (std::ptrdiff_t k = first[2]; k <= last[2]; ++k) {
    for (std::ptrdiff_t j = first[1]; j <= last[1]; ++j) {
      for (std::ptrdiff_t i = first[0]; i <= last[0]; ++i) {
        const std::ptrdiff_t voxel = (k * grid.size[1] + j) * grid.size[0] + i;
        const float value = source.light != nullptr ? source.light[4 * voxel]
                            : source.cell_corners != nullptr
                                ? static_cast<float>(source.cell_corners[voxel] & 255)
                                : source.greys[voxel];
        low = std::min(low, value);
        high = std::max(high, value);
      }
    }
  }
  return {low, high};
}

/// One source's sample.
struct Sampled {
  Classified classified;         // of grey values
  std::array<float, 4> light{};  // of light

  Sampled(const MarchSource& source, const Place& place) {
    if (source.light != nullptr) {
      light = place.fours(source.light);
    } else {
      classified = classify(*source.curve, place.grey(source));
    }
  }
};

using Samples = std::vector<Sampled>;  // by source

Samples sample(const MarchScene& scene, const LoneRay& ray, float t) {
  const Place place(scene.grid, ray, t);
  Samples samples;
  for (const MarchSource& source : scene.sources) samples.emplace_back(source, place);
  return samples;
}

/// Extinction, and emission in red, green and blue.
using Light = std::array<float, 4>;

/// Means of a step, and at its ends.
struct StepLight {
  Light mean{}, before{}, after{};

  /// Of one source.
  void add(const MarchSource& source, const Sampled& from, const Sampled& to, const Place& middle) {
    if (source.light != nullptr) {
      for (std::size_t c = 0; c < 4; ++c) {
        mean[c] += 0.5f * (from.light[c] + to.light[c]);
        before[c] += from.light[c];
        after[c] += to.light[c];
      }
      return;
    }
    const auto [extinction, emission] = means(*source.curve, from.classified, to.classified);
    if (extinction <= 0) return;
    Light color{source.color[0], source.color[1], source.color[2], 1};
    if (source.colors != nullptr) color = middle.fours(source.colors);
    const auto add_grey = [&](float k, float e, Light& sum) {
      sum[0] += k;
      for (std::size_t c = 0; c < 3; ++c) sum[c + 1] += e / std::max(color[3], 1e-12f) * color[c];
    };
    const Classified& a = from.classified;
    const Classified& b = to.classified;
    add_grey(extinction, emission, mean);
    add_grey(a.extinction, a.extinction * a.shade, before);
    add_grey(b.extinction, b.extinction * b.shade, after);
  }

  /// What is emitted further in front is hidden less (StepLight of march_optics-inl.h).
  void composite(float length, std::array<float, 4>& rgba) const {
    const float depth = mean[0] * length;
    if (depth <= 0) return;
    const float through = 1 - rgba[3];
    const float absorbed = -std::expm1(-depth);
    const float shift = absorbed / depth - 1 + absorbed / 2;
    const float ends = std::max(before[0] + after[0], kMinEnds * mean[0]);
    for (std::size_t c = 0; c < 3; ++c) {
      const float color = mean[c + 1] / mean[0];
      const float rise = (after[c + 1] - after[0] * color) - (before[c + 1] - before[0] * color);
      const float light = absorbed * color + 2 * rise / ends * shift;
      rgba[c] += through * std::clamp(light, 0.0f, absorbed * std::max(color, 1.0f));
    }
    rgba[3] += through * absorbed;
  }
};

int steps_of(const MarchScene& scene, const LoneRay& ray, float at, float end, float weight) {
  if (scene.tolerance <= 0) return scene.min_steps;
  float varies = 0;
  for (std::size_t s = 0; s < scene.sources.size(); ++s) {
    const MarchSource& source = scene.sources[s];
    const auto [low, high] = range_between(scene.grid, source, ray, at, end);
    varies +=
        source.light != nullptr ? high - low : variation(*source.curve, high) - variation(*source.curve, low);
  }
  const float most = weight * varies / (kEvenShare * scene.tolerance);
  const float steps = std::ceil(std::cbrt(most * most));
  return static_cast<int>(
      std::clamp(steps, static_cast<float>(scene.min_steps), static_cast<float>(scene.max_steps)));
}

/// Composites the way between two samples.
void step(const MarchScene& scene, const LoneRay& ray, const Samples& before, const Samples& after, float at,
          float next, std::array<float, 4>& rgba) {
  const Place middle(scene.grid, ray, 0.5f * (at + next));
  StepLight light;
  for (std::size_t s = 0; s < scene.sources.size(); ++s) {
    light.add(scene.sources[s], before[s], after[s], middle);
  }
  light.composite(ray.mm_per_t * (next - at), rgba);
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

/// A slab in steps of equal lengths, from `before`, where the ray is at `begin`, to `last`. Rays that enter
/// or leave within a slab take all of them inside.
void even_slab(const MarchScene& scene, const LoneRay& ray, float begin, float end, Samples before,
               const Samples& last, std::array<float, 4>& rgba) {
  const int steps = steps_of(scene, ray, begin, end, (1 - rgba[3]) * ray.mm_per_t * (end - begin));
  float at = begin;
  for (int n = 1; n <= steps; ++n) {
    const float part = static_cast<float>(n) / static_cast<float>(steps);
    const float next = n == steps ? end : std::fma(part, end - begin, begin);
    const Samples after = n == steps ? last : sample(scene, ray, next);
    step(scene, ray, before, after, at, next, rgba);
    before = after;
    at = next;
  }
}

/// The grey value along a ray within a cell, up to `end`.
struct Cubic {
  std::array<float, 4> points{};
  float end = 0;
  int halvings = 0;

  Cubic first_half(float at) {
    const auto middle = [](float a, float b) { return 0.5f * (a + b); };
    const auto [a, b, c, d] = points;
    const float ab = middle(a, b), bc = middle(b, c), cd = middle(c, d);
    const float at_middle = middle(middle(ab, bc), middle(bc, cd));
    ++halvings;
    points = {at_middle, middle(bc, cd), cd, d};
    return {{a, ab, middle(ab, bc), at_middle}, middle(at, end), halvings};
  }
};

/// A slab of grey values of bytes as march_tolerance.h says.
class CutSlab {
 public:
  CutSlab(const MarchScene& scene, const LoneRay& ray, const Sampled& before, std::array<float, 4>& rgba)
      : scene_(scene),
        source_(scene.sources[0]),
        curve_(*source_.curve),
        ray_(ray),
        before_(before),
        rgba_(rgba) {}

  void pass(float at, float end, const Sampled& last) {
    const auto [low, high] = range_between(scene_.grid, source_, ray_, at, end);
    const float weight = (1 - rgba_[3]) * ray_.mm_per_t * (end - at) / scene_.tolerance;
    switch (way(weight, low, high)) {
      case SlabMethod::kStraight: step(at, end, last.classified, 0); break;
      case SlabMethod::kBent: {
        const float middle = Place(scene_.grid, ray_, 0.5f * (at + end)).grey(source_);
        const float straight = 0.5f * (before_.classified.grey + last.classified.grey);
        step(at, end, last.classified, kSimpson * (middle - straight));
        break;
      }
      case SlabMethod::kCut: cut(at, end); break;
    }
  }

 private:
  [[nodiscard]] SlabMethod way(float weight, float low, float high) const {
    const float first = variation(curve_, low), last = variation(curve_, high);
    const float varies = weight * (last - first);
    if (varies <= 1) return SlabMethod::kStraight;
    if (varies > kMaxVariation) return SlabMethod::kCut;
    if (segment(low) == segment(high)) return SlabMethod::kBent;
    const float kinks = weight * std::abs(first + last - 2 * variation(curve_, 0.5f * (low + high)));
    return kinks <= kMaxKinks ? SlabMethod::kBent : SlabMethod::kCut;
  }
  [[nodiscard]] std::size_t segment(float grey) const { return classify(curve_, grey).segment; }

  void cut(float at, float end) {
    std::array<float, 3> cuts{end, end, end};  // where the ray passes from cell to cell
    for (std::size_t a = 0; a < 3; ++a) {
      const float step = ray_.step[a];
      const float place = std::fma(step, end, ray_.origin[a]);
      const float plane = step > 0 ? std::floor(place) : std::ceil(place);
      if (std::abs(step) < 1e-6f) continue;
      const float t = (plane - ray_.origin[a]) / step;
      if (t > at && t < end) cuts[a] = t;
    }
    std::sort(cuts.begin(), cuts.end());
    cuts[2] = end;
    for (const float next : cuts) {
      if (next > at) cut_cell(at, next);
      at = next;
    }
  }

  void cut_cell(float at, float end) {
    std::vector<Cubic> rest{cubic(at, end)};
    while (!rest.empty()) {
      Cubic& nearest = rest.back();
      if (nearest.halvings < kMaxHalvings && !is_straight(at, nearest)) {
        const Cubic half = nearest.first_half(at);
        rest.push_back(half);
        continue;
      }
      const auto [a, b, c, d] = nearest.points;
      step(at, nearest.end, classify(curve_, d), 0.25f * (b + c - a - d));
      at = nearest.end;
      rest.pop_back();
    }
  }

  /// By the values at a third and two thirds of the way.
  [[nodiscard]] Cubic cubic(float at, float end) const {
    const Place middle(scene_.grid, ray_, 0.5f * (at + end));
    const std::uint64_t cell_corners_of_voxel = source_.cell_corners[middle.corner[0]];
    const auto value = [&](float t) {
      float sum = 0;
      for (std::size_t n = 0; n < 8; ++n) {
        float weight = 1;
        for (std::size_t a = 0; a < 3; ++a) {
          const float part = middle.part[a] + ray_.step[a] * (t - 0.5f * (at + end));
          weight *= (n >> a & 1) != 0 ? part : 1 - part;
        }
        sum += weight * static_cast<float>(cell_corners_of_voxel >> (8 * n) & 255);
      }
      return sum;
    };
    const float a = value(at), d = value(end);
    const float third = value(at + (end - at) / 3), two_thirds = value(end - (end - at) / 3);
    return {{a, (18 * third - 9 * two_thirds - 5 * a + 2 * d) / 6,
             (18 * two_thirds - 9 * third - 5 * d + 2 * a) / 6, d},
            end};
  }

  [[nodiscard]] bool is_straight(float at, const Cubic& cubic) const {
    const auto& p = cubic.points;
    const auto [low, high] = std::minmax({p[0], p[1], p[2], p[3]});
    if (segment(low) == segment(high)) return true;
    const float third = (p[3] - p[0]) / 3;
    const float deviation = std::max(std::abs(p[1] - p[0] - third), std::abs(p[3] - p[2] - third));
    const float weight = (1 - rgba_[3]) * ray_.mm_per_t * (cubic.end - at);
    return weight * (variation(curve_, high) - variation(curve_, low)) * deviation <=
           kMaxShift * scene_.tolerance * (high - low);
  }

  /// The grey value's mean is `bend` above the straight line's.
  void step(float at, float next, const Classified& after, float bend) {
    const Classified& before = before_.classified;
    const std::array<float, 2> mean = bent(curve_, before, after, means(curve_, before, after), bend);
    const auto light = [&](float k, float e) {
      return Light{k, e * source_.color[0], e * source_.color[1], e * source_.color[2]};
    };
    const StepLight step{light(mean[0], mean[1]), light(before.extinction, before.extinction * before.shade),
                         light(after.extinction, after.extinction * after.shade)};
    step.composite(ray_.mm_per_t * (next - at), rgba_);
    before_.classified = after;
  }

  const MarchScene& scene_;
  const MarchSource& source_;
  const PreintegratedTransfer& curve_;
  const LoneRay& ray_;
  Sampled before_;
  std::array<float, 4>& rgba_;
};

void march_ray(const MarchScene& scene, LoneRay ray, std::array<float, 4>& rgba) {
  if (!clip(scene.grid, ray)) return;
  const auto clamped = [&](float t) { return std::min(std::max(t, ray.from), ray.to); };
  Samples before = sample(scene, ray, ray.from);
  float at = ray.from;
  for (float slab = std::floor(ray.from); at < ray.to && 1 - rgba[3] > scene.floor; ++slab) {
    const float end = clamped(slab + 1);
    const Samples last = sample(scene, ray, end);
    if (cuts_cells(scene)) {
      CutSlab(scene, ray, before[0], rgba).pass(at, end, last[0]);
    } else {
      even_slab(scene, ray, at, end, before, last, rgba);
    }
    before = last;
    at = end;
  }
}

void march(const MarchScene& scene, const RayPacket& rays, RadiancePacket& light) {
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

// The march once for every instruction set: Highway compiles this file again and again.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "player/rays/march_simd.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include <algorithm>
#include <cmath>
#include <cstdint>

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include "player/rays/march_kernels.h"
#if HWY_TARGET != HWY_SCALAR
#include "player/rays/march_optics-inl.h"
#include "player/rays/march_packet-inl.h"
#include "player/rays/march_samples-inl.h"
#include "player/rays/march_single_appearance-inl.h"
#endif

HWY_BEFORE_NAMESPACE();
namespace splatlas::HWY_NAMESPACE {
#if HWY_TARGET == HWY_SCALAR

void MarchPacket(const MarchScene& scene, const RayPacket& packet, RadiancePacket& light) {
  scalar_march().march(scene, packet, light);
}

#else
namespace hn = hwy::HWY_NAMESPACE;

/// Any selection.
class MultiAppearance {
 public:
  HWY_INLINE MultiAppearance(const MarchScene& scene, const Rays& rays, Sum& sum)
      : scene_(scene), rays_(rays), sum_(sum) {
    Forget();
  }

  HWY_INLINE void Forget() {
    for (std::size_t n = 0; n < scene_.sources.size(); ++n) states_[n].valid = false;
  }
  HWY_INLINE void Finish() {}

  HWY_INLINE void Stride(float t, const std::int32_t* from, const std::int32_t* to) {
    Choose(from, to);
    auto at = rays_.Clamped(t);
    Begin(at);
    for (std::size_t slab = 0; slab < kSlabs; ++slab) {
      const auto end = rays_.Clamped(t + static_cast<float>(slab + 1));
      Slab(at, end);
      at = end;
    }
  }

 private:
  /// One source's sample.
  struct State {
    Classified classified;  // of grey values
    Vector low, high;       // the lowest and highest of the voxels around: greys, or extinction
    Four light;             // of light
    bool valid;             // it is where the next step begins
  };

  /// The sources that show something in these bricks.
  HWY_INLINE void Choose(const std::int32_t* from, const std::int32_t* to) {
    chosen_count_ = 0;
    for (std::size_t n = 0; n < scene_.sources.size(); ++n) {
      if (scene_.sources.size() == 1 || AnyActive(scene_.sources[n].active, scene_.grid, from, to)) {
        chosen_[chosen_count_++] = n;
      } else {
        states_[n].valid = false;
      }
    }
  }

  HWY_INLINE void Begin(Vector at) {
    const Places places(scene_.grid, rays_, at);
    cells_ = hn::Load(Ints(), places.cells);
    for (std::size_t c = 0; c < chosen_count_; ++c) {
      if (!states_[chosen_[c]].valid) Take(chosen_[c], places, states_[chosen_[c]]);
    }
  }

  HWY_INLINE void Take(std::size_t number, const Places& places, State& state) const {
    const MarchSource& source = scene_.sources[number];
    state.valid = true;
    if (source.light != nullptr) {
      const FourSampler sampler(source.light, scene_.grid, places);
      state.light = sampler.Between();
      if (scene_.tolerance > 0) sampler.Range(state.low, state.high);
      return;
    }
    const Grey grey = source.cell_corners != nullptr ? SampleCellCorners(source.cell_corners, places)
                                                     : SampleGreys(source.greys, scene_.grid, places);
    state.classified = Classify(*source.curve, grey.value);
    state.low = grey.low;
    state.high = grey.high;
  }

  /// One slab, in as many steps as it takes.
  HWY_INLINE void Slab(Vector begin, Vector end) {
    const Places places(scene_.grid, rays_, end);
    for (std::size_t c = 0; c < chosen_count_; ++c) Take(chosen_[c], places, ends_[chosen_[c]]);
    const auto length = hn::Sub(end, begin);
    const auto end_cells = hn::Load(Ints(), places.cells);
    const int steps = Steps(begin, end, end_cells);
    cells_ = end_cells;
    auto at = begin;
    for (int n = 1; n < steps; ++n) {
      const auto next = PartOf(begin, length, n, steps);
      const Places between(scene_.grid, rays_, next);
      for (std::size_t c = 0; c < chosen_count_; ++c) Take(chosen_[c], between, nexts_[chosen_[c]]);
      Step(at, next, nexts_);
      at = next;
    }
    Step(at, end, ends_);
  }

  HWY_INLINE int Steps(Vector begin, Vector end, IntVector end_cells) const {
    if (scene_.tolerance <= 0) return scene_.min_steps;
    const Lanes d;
    const auto between = rays_.CellsBetween(cells_, end_cells, begin, end);
    const auto length = hn::Mul(rays_.mm_per_t, hn::Sub(end, begin));
    auto variation = hn::Zero(d);
    for (std::size_t c = 0; c < chosen_count_; ++c) {
      const MarchSource& source = scene_.sources[chosen_[c]];
      const State& before = states_[chosen_[c]];
      const State& after = ends_[chosen_[c]];
      auto low = hn::Min(before.low, after.low), high = hn::Max(before.high, after.high);
      Widen(source, between, low, high);
      if (source.light == nullptr) {
        low = VariationUpTo(*source.curve, low);
        high = VariationUpTo(*source.curve, high);
      }
      variation = hn::Add(variation, hn::Sub(high, low));
    }
    return StepsOf(scene_, hn::Mul(hn::Mul(sum_.Through(), length), variation));
  }

  /// A range of voxels' values by those of the cells that neither end of a slab is in.
  HWY_INLINE void Widen(const MarchSource& source, const Rays::Between& between, Vector& low,
                        Vector& high) const {
    if (source.cell_corners != nullptr) {
      WidenByCellCorners(source.cell_corners, between.beside, low, high);
      if (between.has_corner) WidenByCellCorners(source.cell_corners, between.corner, low, high);
    } else if (source.greys != nullptr) {
      WidenByFaces<1>(source.greys, between, low, high);
    } else {
      WidenByFaces<4>(source.light, between, low, high);
    }
  }
  static HWY_INLINE void WidenByCellCorners(const std::uint64_t* cell_corners, IntVector cells, Vector& low,
                                            Vector& high) {
    const CellCorners here(cell_corners, cells);
    low = hn::Min(low, here.LowWith());
    high = hn::Max(high, here.HighWith());
  }
  /// Of the cell beside one at an end, the other face is that one's.
  template <std::ptrdiff_t kEach>
  HWY_INLINE void WidenByFaces(const float* values, const Rays::Between& between, Vector& low,
                               Vector& high) const {
    WidenByFace<kEach>(values, between.beside, rays_.across, low, high);
    if (!between.has_corner) return;
    WidenByFace<kEach>(values, between.corner, rays_.across, low, high);
    WidenByFace<kEach>(values, hn::Add(between.corner, rays_.layer), rays_.across, low, high);
  }

  /// Extinction, and emission in red, green and blue: means of a step, and at its ends.
  struct Mixed {
    Four mean, before, after;
  };

  HWY_INLINE void AddLight(const Four& before, const Four& after, Mixed& mixed) const {
    const auto half = hn::Set(Lanes(), 0.5f);
    for (std::size_t n = 0; n < 4; ++n) {
      mixed.mean.of[n] = hn::MulAdd(half, hn::Add(before.of[n], after.of[n]), mixed.mean.of[n]);
      mixed.before.of[n] = hn::Add(mixed.before.of[n], before.of[n]);
      mixed.after.of[n] = hn::Add(mixed.after.of[n], after.of[n]);
    }
  }

  /// Extinction, and emission in a colour per shade.
  static HWY_INLINE void AddGrey(Vector extinction, Vector emission, const Vector* color, Four& sum) {
    sum.of[0] = hn::Add(sum.of[0], extinction);
    for (std::size_t n = 0; n < 3; ++n) sum.of[n + 1] = hn::MulAdd(emission, color[n], sum.of[n + 1]);
  }

  HWY_INLINE void AddGreys(const MarchSource& source, const Classified& before, const Classified& after,
                           Vector middle, Mixed& mixed) const {
    const Lanes d;
    const Means means(*source.curve, before, after);
    if (hn::AllTrue(d, hn::Le(means.extinction, hn::Zero(d)))) return;
    Vector color[3];
    if (source.colors == nullptr) {
      for (std::size_t n = 0; n < 3; ++n) color[n] = hn::Set(d, source.color[n]);
    } else {
      const Places places(scene_.grid, rays_, middle);
      const Four sampled = FourSampler(source.colors, scene_.grid, places).Between();
      const auto share = hn::Div(hn::Set(d, 1.0f), hn::Max(sampled.of[3], hn::Set(d, 1e-12f)));
      for (std::size_t n = 0; n < 3; ++n) color[n] = hn::Mul(share, sampled.of[n]);
    }
    AddGrey(means.extinction, means.emission, color, mixed.mean);
    AddGrey(before.extinction, hn::Mul(before.extinction, before.shade), color, mixed.before);
    AddGrey(after.extinction, hn::Mul(after.extinction, after.shade), color, mixed.after);
  }

  /// From `at`, where the states are, to `next`, where they are `after`.
  HWY_INLINE void Step(Vector at, Vector next, const State* after) {
    const Lanes d;
    const auto none = hn::Zero(d);
    Mixed mixed{{none, none, none, none}, {none, none, none, none}, {none, none, none, none}};
    const auto middle = hn::Mul(hn::Set(d, 0.5f), hn::Add(at, next));
    for (std::size_t c = 0; c < chosen_count_; ++c) {
      const MarchSource& source = scene_.sources[chosen_[c]];
      State& before = states_[chosen_[c]];
      const State& now = after[chosen_[c]];
      if (source.light != nullptr) {
        AddLight(before.light, now.light, mixed);
      } else {
        AddGreys(source, before.classified, now.classified, middle, mixed);
      }
      before = now;
    }
    const auto length = hn::Mul(rays_.mm_per_t, hn::Sub(next, at));
    if (hn::AllTrue(d, hn::Le(hn::Mul(mixed.mean.of[0], length), hn::Zero(d)))) return;
    const StepLight light(mixed.mean.of[0], mixed.before.of[0], mixed.after.of[0], length);
    const auto through = sum_.Through();
    for (std::size_t n = 0; n < 3; ++n) {
      const auto of_color = light.Of(mixed.mean.of[n + 1], mixed.before.of[n + 1], mixed.after.of[n + 1]);
      sum_.color[n] = hn::MulAdd(through, of_color, sum_.color[n]);
    }
    sum_.opacity = hn::MulAdd(through, light.Absorbed(), sum_.opacity);
  }

  const MarchScene& scene_;
  const Rays& rays_;
  Sum& sum_;
  State states_[kMaxSources];  // of the sources where the next step begins,
  State ends_[kMaxSources];    // where the slab ends,
  State nexts_[kMaxSources];   // and where the step does
  IntVector cells_;            // where the slab begins
  std::size_t chosen_[kMaxSources];
  std::size_t chosen_count_ = 0;
};

/// Tells the bricks that the rays come by, too.
HWY_INLINE bool AnyWithin(const MarchScene& scene, const Bounds& bounds, float t0, float t1,
                          std::int32_t* from, std::int32_t* to) {
  bounds.Bricks(scene.grid, t0, t1, from, to);
  return AnyActive(scene.active, scene.grid, from, to);
}

/// Walks the bricks that the rays come by.
template <typename Appearances>
void March(const MarchScene& scene, const Rays& rays, Sum& sum) {
  const Lanes d;
  const auto counts = rays.Counts();
  if (hn::AllFalse(d, counts)) return;
  constexpr auto kStride = static_cast<float>(kSlabs);
  constexpr float kLeap = 4 * kStride;
  const auto never = hn::Set(d, 1e9f);
  const float enter = hn::GetLane(hn::MinOfLanes(d, hn::IfThenElse(counts, rays.from, never)));
  const float leave = hn::GetLane(hn::MaxOfLanes(d, hn::IfThenElse(counts, rays.to, hn::Neg(never))));
  const float first = std::floor(enter / kStride) * kStride;
  const float last = std::ceil(leave / kStride) * kStride;
  const Bounds bounds(rays, counts, first, last);
  Appearances appearances(scene, rays, sum);
  float leap_from = first;  // up to there something is within a leap
  for (float t = first; t < last; t += kStride) {
    std::int32_t from[3], to[3];
    if (!AnyWithin(scene, bounds, t, t + kStride, from, to)) {
      appearances.Forget();
      if (t < leap_from) continue;
      float next = t + kStride;
      while (next < last && !AnyWithin(scene, bounds, next, next + kLeap, from, to)) next += kLeap;
      leap_from = next + kLeap;
      t = next - kStride;
      continue;
    }
    appearances.Stride(t, from, to);
    const auto hidden = hn::Le(sum.Through(), hn::Set(d, scene.floor));
    if (hn::AllTrue(d, hn::Or(hidden, hn::Not(counts)))) break;
  }
  appearances.Finish();
}

void MarchPacket(const MarchScene& scene, const RayPacket& packet, RadiancePacket& light) {
  const Lanes d;
  const bool single_appearance = scene.sources.size() == 1 && scene.sources[0].cell_corners != nullptr &&
                                 scene.sources[0].colors == nullptr;
  for (std::size_t first = 0; first < kPacketRays; first += hn::Lanes(d)) {
    const Rays rays(scene.grid, packet, first);
    Sum sum;
    for (std::size_t c = 0; c < 3; ++c) sum.color[c] = hn::Load(d, light.planes[c].data() + first);
    sum.opacity = hn::Load(d, light.planes[3].data() + first);
    if (single_appearance && ShortCurve::fits(*scene.sources[0].curve)) {
      March<SingleAppearance<ShortCurve>>(scene, rays, sum);
    } else if (single_appearance) {
      March<SingleAppearance<LongCurve>>(scene, rays, sum);
    } else {
      March<MultiAppearance>(scene, rays, sum);
    }
    for (std::size_t c = 0; c < 3; ++c) hn::Store(sum.color[c], d, light.planes[c].data() + first);
    hn::Store(sum.opacity, d, light.planes[3].data() + first);
  }
}
#endif  // HWY_TARGET == HWY_SCALAR

}  // namespace splatlas::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "player/simd/simd_choice.h"

namespace splatlas {
namespace {

HWY_EXPORT(MarchPacket);

void march(const MarchScene& scene, const RayPacket& rays, RadiancePacket& light) {
  HWY_DYNAMIC_DISPATCH(MarchPacket)(scene, rays, light);
}

}  // namespace

const MarchKernels& best_march() {
  static const MarchKernels kKernels =
      scalar_is_forced() ? scalar_march() : MarchKernels{best_target(), march};
  return kKernels;
}

}  // namespace splatlas
#endif  // HWY_ONCE

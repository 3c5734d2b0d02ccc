// The march once for every instruction set: Highway compiles this file again and again.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "player/march_simd.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include <algorithm>
#include <cmath>
#include <cstdint>

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include "player/march_kernels.h"
#if HWY_TARGET != HWY_SCALAR
#include "player/march_looks-inl.h"
#include "player/march_rays-inl.h"
#include "player/march_samples-inl.h"
#endif

HWY_BEFORE_NAMESPACE();
namespace splatlas::HWY_NAMESPACE {
#if HWY_TARGET == HWY_SCALAR

void MarchPacket(const MarchScene& scene, const RayPacket& packet, LightPacket& light) {
  scalar_march().march(scene, packet, light);
}

#else
namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kSlabs = MarchGrid::kBrick;  // walked in one stride
/// Share of the tolerance below which a whole stride is one step.
constexpr float kFaintShare = 0.03f;
constexpr std::size_t kPrefetchedLanes = 3;  // one of so many: their neighbours' cells share cache lines

/// What has been added up along the rays.
struct Sum {
  Vector color[3], opacity;

  HWY_INLINE Vector Through() const { return hn::Sub(hn::Set(Lanes(), 1.0f), opacity); }
};

/// Steps of a slab: what may be wrong by `weight` at most, and falls with the square of the steps, or, at
/// steps of the transfer function, with their power of 3/2.
HWY_INLINE int StepsOf(const MarchScene& scene, Vector weight) {
  const float most = hn::GetLane(hn::MaxOfLanes(Lanes(), weight)) / scene.tolerance;
  const auto least = static_cast<float>(scene.least_steps);
  if (most <= 1) return scene.least_steps;
  const float steps = std::ceil(std::cbrt(most * most));
  return static_cast<int>(std::clamp(steps, least, static_cast<float>(scene.most_steps)));
}

/// A selection with one transfer function and one colour, of bytes: the common case.
class OneLook {
 public:
  HWY_INLINE OneLook(const MarchScene& scene, const Rays& rays, Sum& sum)
      : scene_(scene),
        rays_(rays),
        sum_(sum),
        octants_(scene.sources[0].octants),
        curve_(*scene.sources[0].curve),
        emitted_(hn::Zero(Lanes())) {}

  HWY_INLINE void Forget() { valid_ = false; }

  /// Rays come by cells that no other has come by for long: the machine's own prefetching does not help.
  HWY_INLINE void Prefetch(float t) const {
    HWY_ALIGN std::int32_t cells[kPacketRays];
    for (std::size_t slab = 0; slab < kSlabs; ++slab) {
      const Places places(scene_.grid, rays_, rays_.Clamped(t + static_cast<float>(slab) + 0.5f));
      hn::Store(places.cell, Ints(), cells);
      for (std::size_t n = 0; n < hn::Lanes(Lanes()); n += kPrefetchedLanes)
        hwy::Prefetch(octants_ + cells[n]);
    }
  }

  /// From t on. All samples first: nothing that follows has to wait for memory.
  HWY_INLINE void Stride(float t, const std::int32_t* /*from*/, const std::int32_t* /*to*/) {
    auto at = rays_.Clamped(t);
    if (!valid_) last_ = Take(at);
    valid_ = true;
    if (IsFaint()) {
      const auto end = rays_.Clamped(t + static_cast<float>(kSlabs));
      const Taken taken = Take(end);
      Step(hn::Sub(end, at), taken.classified);
      last_ = taken;
      return;
    }
    Taken ends[kSlabs];
    for (std::size_t slab = 0; slab < kSlabs; ++slab) {
      ends[slab] = Take(rays_.Clamped(t + static_cast<float>(slab + 1)));
    }
    for (std::size_t slab = 0; slab < kSlabs; ++slab) {
      const float begin = t + static_cast<float>(slab);
      const auto end = rays_.Clamped(begin + 1);
      Slab(begin, at, end, ends[slab]);
      at = end;
    }
  }

  HWY_INLINE void Finish() {
    for (std::size_t c = 0; c < 3; ++c) {
      const auto color = hn::Set(Lanes(), scene_.sources[0].color[c]);
      sum_.color[c] = hn::MulAdd(color, emitted_, sum_.color[c]);
    }
  }

 private:
  struct Taken {
    Octants octants;
    Classified classified;
  };
  HWY_INLINE Taken Take(Vector t) const {
    const Places places(scene_.grid, rays_, t);
    const Octants octants(octants_, places);
    return {octants, Classify(curve_, octants.Value(places))};
  }

  /// What is still seen of a stride is so little that one step does.
  HWY_INLINE bool IsFaint() const {
    const Lanes d;
    const auto weight = hn::Mul(hn::Mul(sum_.Through(), rays_.mm_per_t), hn::Set(d, curve_.variation()));
    return scene_.tolerance > 0 && hn::AllTrue(d, hn::Le(weight, hn::Set(d, kFaintShare * scene_.tolerance)));
  }

  HWY_INLINE void Slab(float begin, Vector at, Vector end, const Taken& taken) {
    const int steps = Steps(hn::Mul(rays_.mm_per_t, hn::Sub(end, at)), taken);
    for (int n = 1; n < steps; ++n) {
      const auto next = rays_.Clamped(begin + static_cast<float>(n) / static_cast<float>(steps));
      const Places places(scene_.grid, rays_, next);
      const Classified between = Classify(curve_, Octants(octants_, places).Value(places));
      Step(hn::Sub(next, at), between);
      last_.classified = between;
      at = next;
    }
    if (steps > 0) Step(hn::Sub(end, at), taken.classified);
    last_ = taken;
  }

  /// 0 where nothing shows.
  HWY_INLINE int Steps(Vector length, const Taken& end) const {
    if (scene_.tolerance <= 0) return scene_.least_steps;
    const Lanes d;
    const auto weight = hn::Mul(sum_.Through(), length);
    const auto at_most = hn::Mul(weight, hn::Set(d, curve_.variation()));
    if (hn::AllTrue(d, hn::Le(at_most, hn::Set(d, scene_.tolerance)))) return scene_.least_steps;
    const auto low = VariationUpTo(curve_, last_.octants.LowWith(end.octants));
    const auto high = VariationUpTo(curve_, last_.octants.HighWith(end.octants));
    return StepsOf(scene_, hn::Mul(weight, hn::Sub(high, low)));
  }

  HWY_INLINE void Step(Vector part, const Classified& next) {
    const Lanes d;
    const auto most = hn::Max(last_.classified.extinction, next.extinction);
    const auto crossed = hn::RebindMask(d, hn::Eq(last_.classified.segment, next.segment));
    if (hn::AllTrue(d, hn::And(crossed, hn::Le(most, hn::Zero(d))))) return;
    const Means means(curve_, last_.classified, next);
    const auto length = hn::Mul(rays_.mm_per_t, part);
    const Absorption slab(hn::Mul(means.extinction, length));
    const auto through = sum_.Through();
    emitted_ = hn::MulAdd(hn::Mul(hn::Mul(through, length), slab.mean), means.emission, emitted_);
    sum_.opacity = hn::MulAdd(through, slab.absorbed, sum_.opacity);
  }

  const MarchScene& scene_;
  const Rays& rays_;
  Sum& sum_;
  const std::uint64_t* octants_;
  const GreyCurve& curve_;
  Vector emitted_;  // in the colour
  Taken last_;      // where the next step begins
  bool valid_ = false;
};

/// Any selection.
class ManyLooks {
 public:
  HWY_INLINE ManyLooks(const MarchScene& scene, const Rays& rays, Sum& sum)
      : scene_(scene), rays_(rays), sum_(sum) {
    Forget();
  }

  HWY_INLINE void Forget() {
    for (std::size_t n = 0; n < scene_.sources.size(); ++n) states_[n].valid = false;
  }
  HWY_INLINE void Prefetch(float /*t*/) const {}
  HWY_INLINE void Finish() {}

  HWY_INLINE void Stride(float t, const std::int32_t* from, const std::int32_t* to) {
    Choose(from, to);
    auto at = rays_.Clamped(t);
    Begin(at);
    for (std::size_t slab = 0; slab < kSlabs; ++slab) {
      const float begin = t + static_cast<float>(slab);
      const auto end = rays_.Clamped(begin + 1);
      Slab(begin, at, end);
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
    const Grey grey = source.octants != nullptr ? SampleOctants(source.octants, places)
                                                : SampleGreys(source.greys, scene_.grid, places);
    state.classified = Classify(*source.curve, grey.value);
    state.low = grey.low;
    state.high = grey.high;
  }

  /// One slab, in as many steps as it takes.
  HWY_INLINE void Slab(float begin, Vector at, Vector end) {
    const Places places(scene_.grid, rays_, end);
    for (std::size_t c = 0; c < chosen_count_; ++c) Take(chosen_[c], places, ends_[chosen_[c]]);
    const int steps = Steps(hn::Mul(rays_.mm_per_t, hn::Sub(end, at)));
    for (int n = 1; n < steps; ++n) {
      const auto next = rays_.Clamped(begin + static_cast<float>(n) / static_cast<float>(steps));
      const Places between(scene_.grid, rays_, next);
      for (std::size_t c = 0; c < chosen_count_; ++c) Take(chosen_[c], between, nexts_[chosen_[c]]);
      Step(at, next, nexts_);
      at = next;
    }
    Step(at, end, ends_);
  }

  HWY_INLINE int Steps(Vector length) const {
    if (scene_.tolerance <= 0) return scene_.least_steps;
    const Lanes d;
    auto variation = hn::Zero(d);
    for (std::size_t c = 0; c < chosen_count_; ++c) {
      const MarchSource& source = scene_.sources[chosen_[c]];
      const State& before = states_[chosen_[c]];
      const State& after = ends_[chosen_[c]];
      auto low = hn::Min(before.low, after.low);
      auto high = hn::Max(before.high, after.high);
      if (source.light == nullptr) {
        low = VariationUpTo(*source.curve, low);
        high = VariationUpTo(*source.curve, high);
      }
      variation = hn::Add(variation, hn::Sub(high, low));
    }
    return StepsOf(scene_, hn::Mul(hn::Mul(sum_.Through(), length), variation));
  }

  /// Extinction, and emission in red, green and blue.
  struct Mixed {
    Vector extinction, emission[3];
  };

  HWY_INLINE void AddLight(const Four& before, const Four& after, Mixed& mixed) const {
    const auto half = hn::Set(Lanes(), 0.5f);
    mixed.extinction = hn::MulAdd(half, hn::Add(before.of[0], after.of[0]), mixed.extinction);
    for (std::size_t n = 0; n < 3; ++n) {
      mixed.emission[n] = hn::MulAdd(half, hn::Add(before.of[n + 1], after.of[n + 1]), mixed.emission[n]);
    }
  }

  HWY_INLINE void AddGreys(const MarchSource& source, const Classified& before, const Classified& after,
                           Vector middle, Mixed& mixed) const {
    const Lanes d;
    const Means means(*source.curve, before, after);
    if (hn::AllTrue(d, hn::Le(means.extinction, hn::Zero(d)))) return;
    mixed.extinction = hn::Add(mixed.extinction, means.extinction);
    if (source.colors == nullptr) {
      for (std::size_t n = 0; n < 3; ++n) {
        mixed.emission[n] = hn::MulAdd(means.emission, hn::Set(d, source.color[n]), mixed.emission[n]);
      }
      return;
    }
    const Places places(scene_.grid, rays_, middle);
    const Four color = FourSampler(source.colors, scene_.grid, places).Between();
    const auto share = hn::Div(means.emission, hn::Max(color.of[3], hn::Set(d, 1e-12f)));
    for (std::size_t n = 0; n < 3; ++n) {
      mixed.emission[n] = hn::MulAdd(share, color.of[n], mixed.emission[n]);
    }
  }

  /// From `at`, where the states are, to `next`, where they are `after`.
  HWY_INLINE void Step(Vector at, Vector next, const State* after) {
    const Lanes d;
    Mixed mixed{hn::Zero(d), {hn::Zero(d), hn::Zero(d), hn::Zero(d)}};
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
    const auto depth = hn::Mul(mixed.extinction, length);
    if (hn::AllTrue(d, hn::Le(depth, hn::Zero(d)))) return;
    const Absorption slab(depth);
    const auto through = sum_.Through();
    const auto weight = hn::Mul(hn::Mul(through, length), slab.mean);
    for (std::size_t n = 0; n < 3; ++n) {
      sum_.color[n] = hn::MulAdd(weight, mixed.emission[n], sum_.color[n]);
    }
    sum_.opacity = hn::MulAdd(through, slab.absorbed, sum_.opacity);
  }

  const MarchScene& scene_;
  const Rays& rays_;
  Sum& sum_;
  State states_[kMostSources];  // of the sources where the next step begins,
  State ends_[kMostSources];    // where the slab ends,
  State nexts_[kMostSources];   // and where the step does
  std::size_t chosen_[kMostSources];
  std::size_t chosen_count_ = 0;
};

/// Walks the bricks that the rays come by.
template <typename Looks>
void March(const MarchScene& scene, const Rays& rays, Sum& sum) {
  const Lanes d;
  const auto counts = rays.Counts();
  if (hn::AllFalse(d, counts)) return;
  constexpr auto kStride = static_cast<float>(kSlabs);
  const auto never = hn::Set(d, 1e9f);
  const float enter = hn::GetLane(hn::MinOfLanes(d, hn::IfThenElse(counts, rays.from, never)));
  const float leave = hn::GetLane(hn::MaxOfLanes(d, hn::IfThenElse(counts, rays.to, hn::Neg(never))));
  const float first = std::floor(enter / kStride) * kStride;
  const float last = std::ceil(leave / kStride) * kStride;
  const Bounds bounds(rays, counts, first, last);
  Looks looks(scene, rays, sum);
  for (float t = first; t < last; t += kStride) {
    std::int32_t from[3], to[3];
    bounds.Bricks(scene.grid, t, t + kStride, from, to);
    if (!AnyActive(scene.active, scene.grid, from, to)) {
      looks.Forget();
      continue;
    }
    looks.Prefetch(t + kStride);
    looks.Stride(t, from, to);
    const auto hidden = hn::Le(sum.Through(), hn::Set(d, scene.floor));
    if (hn::AllTrue(d, hn::Or(hidden, hn::Not(counts)))) break;
  }
  looks.Finish();
}

void MarchPacket(const MarchScene& scene, const RayPacket& packet, LightPacket& light) {
  const Lanes d;
  const bool one_look =
      scene.sources.size() == 1 && scene.sources[0].octants != nullptr && scene.sources[0].colors == nullptr;
  for (std::size_t first = 0; first < kPacketRays; first += hn::Lanes(d)) {
    const Rays rays(scene.grid, packet, first);
    Sum sum;
    for (std::size_t c = 0; c < 3; ++c) sum.color[c] = hn::Load(d, light.planes[c].data() + first);
    sum.opacity = hn::Load(d, light.planes[3].data() + first);
    if (one_look) {
      March<OneLook>(scene, rays, sum);
    } else {
      March<ManyLooks>(scene, rays, sum);
    }
    for (std::size_t c = 0; c < 3; ++c) hn::Store(sum.color[c], d, light.planes[c].data() + first);
    hn::Store(sum.opacity, d, light.planes[3].data() + first);
  }
}
#endif  // HWY_TARGET == HWY_SCALAR

}  // namespace splatlas::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "player/simd_choice.h"

namespace splatlas {
namespace {

HWY_EXPORT(MarchPacket);

void march(const MarchScene& scene, const RayPacket& rays, LightPacket& light) {
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

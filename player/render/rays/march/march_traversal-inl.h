// Traversal of a volume by a packet of rays, the hot loop; ray marching through any combination of sources.
// Compiled once for every instruction set.
#if defined(SPLATLAS_PLAYER_MARCH_TRAVERSAL_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SPLATLAS_PLAYER_MARCH_TRAVERSAL_INL_H_
#undef SPLATLAS_PLAYER_MARCH_TRAVERSAL_INL_H_
#else
#define SPLATLAS_PLAYER_MARCH_TRAVERSAL_INL_H_
#endif

#include <cmath>
#include <cstddef>
#include <cstdint>

#include <hwy/highway.h>

#include "player/render/rays/march/march_optics-inl.h"
#include "player/render/rays/march/march_packet-inl.h"
#include "player/render/rays/march/march_samples-inl.h"
#include "player/render/rays/march/march_single_appearance-inl.h"
#include "player/render/rays/march_kernels.h"

HWY_BEFORE_NAMESPACE();
namespace splatlas::HWY_NAMESPACE {

/// Any selection: several transfer functions, floats, pre-classified optical properties.
class MultiAppearance {
 public:
  HWY_INLINE MultiAppearance(const MarchScene& scene, const Rays& rays, Accumulated& accumulated)
      : scene_(scene), rays_(rays), accumulated_(accumulated) {
    Invalidate();
  }

  HWY_INLINE void Invalidate() {
    for (std::size_t n = 0; n < scene_.sources.size(); ++n) states_[n].valid = false;
  }
  HWY_INLINE void Finish() {}

  HWY_INLINE void MarchBatch(float t, const std::int32_t* from, const std::int32_t* to) {
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
    Vector low, high;       // minimum and maximum of the eight corners: grey value or extinction
    Four optics;            // of pre-classified sources
    bool valid;             // taken at the beginning of the next step
  };

  /// Selects the sources with active bricks in this box.
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
    cells_ = Load(Ints(), places.cells);
    for (std::size_t c = 0; c < chosen_count_; ++c) {
      if (!states_[chosen_[c]].valid) Sample(chosen_[c], places, states_[chosen_[c]]);
    }
  }

  HWY_INLINE void Sample(std::size_t number, const Places& places, State& state) const {
    const MarchSource& source = scene_.sources[number];
    state.valid = true;
    if (source.optics != nullptr) {
      const FourSampler sampler(source.optics, scene_.grid, places);
      state.optics = sampler.Between();
      if (scene_.tolerance > 0) sampler.Range(state.low, state.high);
      return;
    }
    const auto mix = [&](Vector a, Vector b, Vector part) HWY_ATTR {  // extinctions as FourSampler
      if (source.transfer != nullptr) return Lerp(a, b, part);
      return FusedMulAdd(Lanes(), part, b, Mul(Sub(Set(Lanes(), 1.0f), part), a));
    };
    const Grey grey = source.cell_corners != nullptr ? SampleCellCorners(source.cell_corners, places)
                                                     : SampleGreys(source.greys, scene_.grid, places, mix);
    if (source.transfer != nullptr) {
      state.classified = Classify(AnyTransfer(*source.transfer), grey.value);
    } else {
      const auto none = Zero(Lanes());
      state.optics = {{grey.value, none, none, none}};
    }
    state.low = grey.low;
    state.high = grey.high;
  }

  /// A slab in equal steps, as many as the tolerance needs.
  HWY_INLINE void Slab(Vector begin, Vector end) {
    const Places places(scene_.grid, rays_, end);
    for (std::size_t c = 0; c < chosen_count_; ++c) Sample(chosen_[c], places, ends_[chosen_[c]]);
    const auto length = Sub(end, begin);
    const auto end_cells = Load(Ints(), places.cells);
    const int steps = Steps(begin, end, end_cells);
    cells_ = end_cells;
    auto at = begin;
    for (int n = 1; n < steps; ++n) {
      const auto next = PartOf(begin, length, n, steps);
      const Places between(scene_.grid, rays_, next);
      for (std::size_t c = 0; c < chosen_count_; ++c) Sample(chosen_[c], between, nexts_[chosen_[c]]);
      Step(at, next, nexts_);
      at = next;
    }
    Step(at, end, ends_);
  }

  HWY_INLINE int Steps(Vector begin, Vector end, IntVector end_cells) const {
    if (scene_.tolerance <= 0) return scene_.min_steps;
    const Lanes d;
    const auto between = rays_.CellsBetween(cells_, end_cells, begin, end);
    const auto length = Mul(rays_.mm_per_t, Sub(end, begin));
    auto variation = Zero(d);
    for (std::size_t c = 0; c < chosen_count_; ++c) {
      const MarchSource& source = scene_.sources[chosen_[c]];
      const State& before = states_[chosen_[c]];
      const State& after = ends_[chosen_[c]];
      auto low = Min(before.low, after.low), high = Max(before.high, after.high);
      Widen(source, between, low, high);
      if (source.transfer != nullptr) {
        low = VariationUpTo(AnyTransfer(*source.transfer), low);
        high = VariationUpTo(AnyTransfer(*source.transfer), high);
      }
      variation = Add(variation, Sub(high, low));
    }
    return StepsOf(scene_, Mul(Mul(accumulated_.Transmittance(), length), variation));
  }

  /// Extends a range by the cells between the two end cells of a slab.
  HWY_INLINE void Widen(const MarchSource& source, const Rays::Between& between, Vector& low,
                        Vector& high) const {
    if (source.cell_corners != nullptr) {
      WidenByCellCorners(source.cell_corners, between.beside, low, high);
      if (between.has_corner) WidenByCellCorners(source.cell_corners, between.corner, low, high);
    } else if (source.greys != nullptr) {
      WidenByFaces<1>(source.greys, between, low, high);
    } else {
      WidenByFaces<4>(source.optics, between, low, high);
    }
  }
  static HWY_INLINE void WidenByCellCorners(const std::uint64_t* cell_corners, IntVector cells, Vector& low,
                                            Vector& high) {
    const CellCorners here(cell_corners, cells);
    low = Min(low, here.LowWith());
    high = Max(high, here.HighWith());
  }
  /// The cell beside an end cell shares its other face with that.
  template <std::ptrdiff_t kEach>
  HWY_INLINE void WidenByFaces(const float* values, const Rays::Between& between, Vector& low,
                               Vector& high) const {
    WidenByFace<kEach>(values, between.beside, rays_.across, low, high);
    if (!between.has_corner) return;
    WidenByFace<kEach>(values, between.corner, rays_.across, low, high);
    WidenByFace<kEach>(values, Add(between.corner, rays_.layer), rays_.across, low, high);
  }

  /// Extinction, and emission in red, green and blue: means over a step, and values at its ends.
  struct Mixed {
    Four mean, before, after;
  };

  HWY_INLINE void AddOptics(const Four& before, const Four& after, Mixed& mixed) const {
    const auto half = Set(Lanes(), 0.5f);
    for (std::size_t n = 0; n < 4; ++n) {
      mixed.mean.of[n] = MulAdd(half, Add(before.of[n], after.of[n]), mixed.mean.of[n]);
      mixed.before.of[n] = Add(mixed.before.of[n], before.of[n]);
      mixed.after.of[n] = Add(mixed.after.of[n], after.of[n]);
    }
  }

  /// Adds extinction and coloured emission.
  static HWY_INLINE void AddGrey(Vector extinction, Vector emission, const VoxelColor& color, Four& sum) {
    sum.of[0] = Add(sum.of[0], extinction);
    for (std::size_t n = 0; n < 3; ++n) sum.of[n + 1] = MulAdd(emission, color.of[n], sum.of[n + 1]);
  }

  HWY_INLINE void AddGreys(const MarchSource& source, const Classified& before, const Classified& after,
                           Vector middle, Mixed& mixed) const {
    const Lanes d;
    const PreintegratedMeans means(AnyTransfer(*source.transfer), before, after);
    if (AllTrue(d, Le(means.extinction, Zero(d)))) return;
    VoxelColor color;
    for (std::size_t n = 0; n < 3; ++n) color.of[n] = Set(d, source.color[n]);
    if (source.colors != nullptr) color = VoxelColor(source.colors, scene_.grid, rays_, middle);
    AddGrey(means.extinction, means.emission, color, mixed.mean);
    AddGrey(before.extinction, Mul(before.extinction, before.shade), color, mixed.before);
    AddGrey(after.extinction, Mul(after.extinction, after.shade), color, mixed.after);
  }

  /// Composites the step from `at` to `next`, where the sources' states are `after`.
  HWY_INLINE void Step(Vector at, Vector next, const State* after) {
    const Lanes d;
    const auto none = Zero(d);
    Mixed mixed{{none, none, none, none}, {none, none, none, none}, {none, none, none, none}};
    const auto middle = Mul(Set(d, 0.5f), Add(at, next));
    for (std::size_t c = 0; c < chosen_count_; ++c) {
      const MarchSource& source = scene_.sources[chosen_[c]];
      State& before = states_[chosen_[c]];
      const State& now = after[chosen_[c]];
      if (source.transfer == nullptr) {
        AddOptics(before.optics, now.optics, mixed);
      } else {
        AddGreys(source, before.classified, now.classified, middle, mixed);
      }
      before = now;
    }
    const auto length = Mul(rays_.mm_per_t, Sub(next, at));
    if (AllTrue(d, Le(Mul(mixed.mean.of[0], length), Zero(d)))) return;
    const SegmentRadiance radiance(mixed.mean.of[0], mixed.before.of[0], mixed.after.of[0], length);
    const auto transmittance = accumulated_.Transmittance();
    for (std::size_t n = 0; n < 3; ++n) {
      const auto of_color = radiance.Of(mixed.mean.of[n + 1], mixed.before.of[n + 1], mixed.after.of[n + 1]);
      accumulated_.color[n] = MulAdd(transmittance, of_color, accumulated_.color[n]);
    }
    accumulated_.opacity = MulAdd(transmittance, radiance.Opacity(), accumulated_.opacity);
    accumulated_.Record(at, next);
  }

  const MarchScene& scene_;
  const Rays& rays_;
  Accumulated& accumulated_;
  State states_[kMaxSources];  // at the beginning of the next step
  State ends_[kMaxSources];    // at the end of the slab
  State nexts_[kMaxSources];   // at the end of the step
  IntVector cells_;            // at the beginning of the slab
  std::size_t chosen_[kMaxSources];
  std::size_t chosen_count_ = 0;
};

/// True if any brick that the packet may cross from t0 to t1 is active. Stores the box of those bricks.
HWY_INLINE bool AnyWithin(const MarchScene& scene, const Bounds& bounds, float t0, float t1,
                          std::int32_t* from, std::int32_t* to) {
  bounds.Bricks(scene.grid, t0, t1, from, to);
  return AnyActive(scene.active, scene.grid, from, to);
}

/// Marches a packet front to back with empty-space skipping and early ray termination.
template <typename Appearance>
void March(const MarchScene& scene, const Rays& rays, Accumulated& accumulated) {
  const Lanes d;
  const auto counts = rays.Counts();
  if (AllFalse(d, counts)) return;

  // Find the batches of slabs between the first entry and the last exit of the packet.
  constexpr auto kBatch = static_cast<float>(kSlabs);
  constexpr float kSkip = 4 * kBatch;
  const auto never = Set(d, 1e9f);
  const float enter = MinLane(d, IfThenElse(counts, rays.from, never));
  const float leave = MaxLane(d, IfThenElse(counts, rays.to, Neg(never)));
  const float first = std::floor(enter / kBatch) * kBatch;
  const float last = std::ceil(leave / kBatch) * kBatch;
  const Bounds bounds(rays, counts, first, last);

  Appearance appearance(scene, rays, accumulated);
  float skip_from = first;  // an active brick lies within kSkip before this
  for (float t = first; t < last; t += kBatch) {
    std::int32_t from[3], to[3];
    if (!AnyWithin(scene, bounds, t, t + kBatch, from, to)) {
      // Skip empty space, several batches at a time.
      appearance.Invalidate();
      if (t < skip_from) continue;
      float next = t + kBatch;
      while (next < last && !AnyWithin(scene, bounds, next, next + kSkip, from, to)) next += kSkip;
      skip_from = next + kSkip;
      t = next - kBatch;
      continue;
    }
    appearance.MarchBatch(t, from, to);
    // Terminate the packet once every ray is nearly opaque.
    const auto opaque = Le(accumulated.Transmittance(), Set(d, scene.termination_threshold));
    if (AllTrue(d, Or(opaque, Not(counts)))) break;
  }
  appearance.Finish();
}

inline void MarchPacket(const MarchScene& scene, const RayPacket& packet, RadiancePacket& radiance) {
  const Lanes d;
  const Rays rays(scene.grid, packet);
  Accumulated accumulated;
  accumulated.trace = radiance.trace;
  for (std::size_t c = 0; c < 3; ++c) accumulated.color[c] = Load(d, radiance.planes[c].data());
  accumulated.opacity = Load(d, radiance.planes[3].data());
  const MarchSource& source = scene.sources[0];
  const bool single = scene.sources.size() == 1 && source.cell_corners != nullptr;
  if (single && ShortTransfer::fits(*source.transfer)) {
    March<SingleAppearance<ShortTransfer>>(scene, rays, accumulated);
  } else if (single) {
    March<SingleAppearance<LongTransfer>>(scene, rays, accumulated);
  } else {
    March<MultiAppearance>(scene, rays, accumulated);
  }
  for (std::size_t c = 0; c < 3; ++c) Store(accumulated.color[c], d, radiance.planes[c].data());
  Store(accumulated.opacity, d, radiance.planes[3].data());
}

}  // namespace splatlas::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // SPLATLAS_PLAYER_MARCH_TRAVERSAL_INL_H_

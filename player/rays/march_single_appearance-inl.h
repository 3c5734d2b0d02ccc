// Through a selection with one transfer function and one colour, of bytes: the common case. Compiled once
// for every instruction set.
#if defined(SPLATLAS_PLAYER_MARCH_SINGLE_APPEARANCE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SPLATLAS_PLAYER_MARCH_SINGLE_APPEARANCE_INL_H_
#undef SPLATLAS_PLAYER_MARCH_SINGLE_APPEARANCE_INL_H_
#else
#define SPLATLAS_PLAYER_MARCH_SINGLE_APPEARANCE_INL_H_
#endif

#include <algorithm>
#include <cmath>

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include "player/rays/march_cubics-inl.h"
#include "player/rays/march_kernels.h"
#include "player/rays/march_optics-inl.h"
#include "player/rays/march_packet-inl.h"
#include "player/rays/march_samples-inl.h"
#include "player/rays/march_tolerance.h"

HWY_BEFORE_NAMESPACE();
namespace splatlas::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kSlabs = MarchGrid::kBrick;  // walked in one stride
/// Of 4 x 4 pixels, as packets have them mostly: cells of the inner ones share cache lines with theirs.
constexpr std::size_t kOuterLanes[] = {0, 1, 2, 3, 4, 7, 8, 11, 12, 13, 14, 15};

/// Steps of a slab: what may be wrong by `weight` at most, and falls with the square of the steps, or, at
/// steps of the transfer function, with their power of 3/2.
HWY_INLINE int StepsOf(const MarchScene& scene, Vector weight) {
  const float most = hn::GetLane(hn::MaxOfLanes(Lanes(), weight)) / (kEvenShare * scene.tolerance);
  const auto least = static_cast<float>(scene.min_steps);
  if (most <= 1) return scene.min_steps;
  const float steps = std::ceil(std::cbrt(most * most));
  return static_cast<int>(std::clamp(steps, least, static_cast<float>(scene.max_steps)));
}

/// `Curve`: the transfer function, as march_optics-inl.h takes it.
template <typename Curve>
class SingleAppearance {
 public:
  HWY_INLINE SingleAppearance(const MarchScene& scene, const Rays& rays, Sum& sum)
      : scene_(scene),
        rays_(rays),
        sum_(sum),
        cell_corners_(scene.sources[0].cell_corners),
        curve_(*scene.sources[0].curve),
        emitted_(hn::Zero(Lanes())) {}

  HWY_INLINE void Forget() { valid_ = false; }

  /// From t on. All samples first: nothing that follows has to wait for memory.
  HWY_INLINE void Stride(float t, const std::int32_t* /*from*/, const std::int32_t* /*to*/) {
    if (ahead_from_ != t) ends_[ahead_] = Ends(scene_.grid, rays_, t);
    const Ends& ends = ends_[ahead_];
    ahead_ = 1 - ahead_;
    LookAhead(t + static_cast<float>(kSlabs));
    auto at = rays_.Clamped(t);
    if (!valid_) last_ = Take(Places(scene_.grid, rays_, at));
    valid_ = true;
    if (IsFaint()) {
      const Taken taken = Take(ends.places[kSlabs - 1]);
      Step(hn::Sub(ends.t[kSlabs - 1], at), taken.classified);
      last_ = taken;
      return;
    }
    Taken taken[kSlabs];
    for (std::size_t slab = 0; slab < kSlabs; ++slab) taken[slab] = Take(ends.places[slab]);
    for (std::size_t slab = 0; slab < kSlabs; ++slab) {
      if (cuts_cells(scene_)) {
        Slab(at, ends.t[slab], taken[slab]);
      } else {
        EvenSlab(at, ends.t[slab], taken[slab]);
      }
      last_ = taken[slab];
      at = ends.t[slab];
    }
  }

  HWY_INLINE void Finish() {
    for (std::size_t c = 0; c < 3; ++c) {
      const auto color = hn::Set(Lanes(), scene_.sources[0].color[c]);
      sum_.color[c] = hn::MulAdd(color, emitted_, sum_.color[c]);
    }
  }

 private:
  /// Where the slabs of a stride end.
  struct Ends {
    Vector t[kSlabs];
    Places places[kSlabs];

    Ends() = default;
    HWY_INLINE Ends(const MarchGrid& grid, const Rays& rays, float from) {
      for (std::size_t slab = 0; slab < kSlabs; ++slab) {
        t[slab] = rays.Clamped(from + static_cast<float>(slab + 1));
        places[slab] = Places(grid, rays, t[slab]);
      }
    }
  };
  struct Taken {
    CellCorners cell_corners;
    Classified classified;
    IntVector cells;
  };
  HWY_INLINE Vector GreyAt(Vector t) const {
    const Places places(scene_.grid, rays_, t);
    return CellCorners(cell_corners_, places).Value(places);
  }
  HWY_INLINE Taken Take(const Places& places) const {
    const CellCorners cell_corners(cell_corners_, places);
    return {cell_corners, Classify(curve_, cell_corners.Value(places)), hn::Load(Ints(), places.cells)};
  }

  struct GreyRange {
    Vector low, high;
  };
  /// Of the voxels around all cells of the slab from `at`, where the last step ended.
  HWY_INLINE GreyRange RangeOf(Vector at, Vector end, const Taken& taken) const {
    const auto between = rays_.CellsBetween(last_.cells, taken.cells, at, end);
    const CellCorners beside(cell_corners_, between.beside);
    if (HWY_LIKELY(!between.has_corner))
      return {beside.LowWith(last_.cell_corners, taken.cell_corners),
              beside.HighWith(last_.cell_corners, taken.cell_corners)};
    const CellCorners corner(cell_corners_, between.corner);
    return {corner.LowWith(beside, last_.cell_corners, taken.cell_corners),
            corner.HighWith(beside, last_.cell_corners, taken.cell_corners)};
  }

  /// Rays come by cells that no other has come by for long: the machine's own prefetching does not help.
  HWY_INLINE void LookAhead(float t) {
    ends_[ahead_] = Ends(scene_.grid, rays_, t);
    ahead_from_ = t;
    for (const Places& places : ends_[ahead_].places) {
      for (const std::size_t lane : kOuterLanes) {
        if (lane < hn::Lanes(Lanes())) hwy::Prefetch(cell_corners_ + places.cells[lane]);
      }
    }
  }

  /// What is still seen of a stride is so little that one step does.
  HWY_INLINE bool IsFaint() const {
    const Lanes d;
    const auto weight = hn::Mul(hn::Mul(sum_.Through(), rays_.mm_per_t), hn::Set(d, curve_.variation()));
    return scene_.tolerance > 0 && hn::AllTrue(d, hn::Le(weight, hn::Set(d, kFaintShare * scene_.tolerance)));
  }

  /// From one plane of voxels to the next in steps of equal lengths.
  HWY_INLINE void EvenSlab(Vector begin, Vector end, const Taken& taken) {
    const auto length = hn::Sub(end, begin);
    const int steps = Steps(begin, end, taken);
    auto at = begin;
    for (int n = 1; n < steps; ++n) {
      const auto next = PartOf(begin, length, n, steps);
      const Classified between = Classify(curve_, GreyAt(next));
      Step(hn::Sub(next, at), between);
      last_.classified = between;
      at = next;
    }
    Step(hn::Sub(end, at), taken.classified);
  }

  /// What is seen through, times the length.
  HWY_INLINE Vector WeightOf(Vector at, Vector end) const {
    return hn::Mul(sum_.Through(), hn::Mul(rays_.mm_per_t, hn::Sub(end, at)));
  }

  HWY_INLINE int Steps(Vector at, Vector end, const Taken& taken) const {
    if (scene_.tolerance <= 0) return scene_.min_steps;
    const Lanes d;
    const auto weight = WeightOf(at, end);
    const auto upper_bound = hn::Mul(weight, hn::Set(d, curve_.variation()));
    const auto most = hn::Set(d, kEvenShare * scene_.tolerance);
    if (hn::AllTrue(d, hn::Le(upper_bound, most))) return scene_.min_steps;
    const GreyRange greys = RangeOf(at, end, taken);
    const auto low = VariationUpTo(curve_, greys.low), high = VariationUpTo(curve_, greys.high);
    return StepsOf(scene_, hn::Mul(weight, hn::Sub(high, low)));
  }

  /// From one plane of voxels to the next as march_tolerance.h says.
  HWY_INLINE void Slab(Vector at, Vector end, const Taken& taken) {
    const Lanes d;
    const auto half = hn::Set(d, 0.5f);
    switch (WayOf(at, end, taken)) {
      case SlabMethod::kStraight: Step(hn::Sub(end, at), taken.classified); break;
      case SlabMethod::kBent: {
        const auto straight = hn::Mul(half, hn::Add(last_.classified.grey, taken.classified.grey));
        const auto above = hn::Sub(GreyAt(hn::Mul(half, hn::Add(at, end))), straight);
        Step(hn::Sub(end, at), taken.classified, hn::Mul(hn::Set(d, kSimpson), above));
        break;
      }
      case SlabMethod::kCut: Cut(at, end); break;
    }
  }

  HWY_INLINE SlabMethod WayOf(Vector at, Vector end, const Taken& taken) const {
    const Lanes d;
    const auto tolerance = hn::Set(d, scene_.tolerance);
    const auto weight = WeightOf(at, end);
    const auto upper_bound = hn::Mul(weight, hn::Set(d, curve_.variation()));
    if (hn::AllTrue(d, hn::Le(upper_bound, tolerance))) return SlabMethod::kStraight;
    const GreyRange greys = RangeOf(at, end, taken);
    const auto low_segment = SegmentOf(curve_, greys.low), high_segment = SegmentOf(curve_, greys.high);
    const auto low = VariationUpTo(curve_, greys.low, low_segment);
    const auto high = VariationUpTo(curve_, greys.high, high_segment);
    const auto varies = hn::Mul(weight, hn::Sub(high, low));
    if (hn::AllTrue(d, hn::Le(varies, tolerance))) return SlabMethod::kStraight;
    const auto most = hn::Mul(hn::Set(d, kMaxVariation), tolerance);
    if (!hn::AllTrue(d, hn::Le(varies, most))) return SlabMethod::kCut;
    const auto middle = VariationUpTo(curve_, hn::Mul(hn::Set(d, 0.5f), hn::Add(greys.low, greys.high)));
    const auto kinks = hn::Mul(weight, hn::Abs(hn::Sub(hn::Add(low, high), hn::Add(middle, middle))));
    const auto few = hn::Le(kinks, hn::Mul(hn::Set(d, kMaxKinks), tolerance));
    const auto linear = hn::RebindMask(d, hn::Eq(low_segment, high_segment));
    return hn::AllTrue(d, hn::Or(few, linear)) ? SlabMethod::kBent : SlabMethod::kCut;
  }

  HWY_NOINLINE void Cut(Vector at, Vector end) {
    Vector cuts[3];
    Crossings(rays_, at, end, cuts);
    for (const Vector& cut : cuts) {
      if (!hn::AllTrue(Lanes(), hn::Le(cut, at))) CutCell(at, cut);
      at = cut;
    }
  }

  /// Halves what is not straight enough again and again.
  HWY_INLINE void CutCell(Vector at, Vector end) {
    Cubic rest[kMaxHalvings + 1];  // what is ahead, the nearest last
    rest[0] = Cubic(cell_corners_, scene_.grid, rays_, at, end);
    std::size_t count = 1;
    while (count > 0) {
      Cubic& cubic = rest[count - 1];
      if (cubic.halvings < kMaxHalvings && !IsStraight(hn::Sub(cubic.t, at), cubic)) {
        rest[count++] = cubic.SplitFirstHalf(at);
        continue;
      }
      const Classified next = Classify(curve_, cubic.points[3]);
      Step(hn::Sub(cubic.t, at), next, cubic.Bend());
      last_.classified = next;
      at = cubic.t;
      --count;
    }
  }

  HWY_INLINE bool IsStraight(Vector part, const Cubic& cubic) const {
    const Lanes d;
    const auto low = cubic.Low(), high = cubic.High();
    const auto low_segment = SegmentOf(curve_, low), high_segment = SegmentOf(curve_, high);
    const auto linear = hn::RebindMask(d, hn::Eq(low_segment, high_segment));
    if (hn::AllTrue(d, linear)) return true;
    const auto variation =
        hn::Sub(VariationUpTo(curve_, high, high_segment), VariationUpTo(curve_, low, low_segment));
    const auto weight = hn::Mul(hn::Mul(sum_.Through(), hn::Mul(rays_.mm_per_t, part)), variation);
    const auto most = hn::Mul(hn::Set(d, kMaxShift * scene_.tolerance), hn::Sub(high, low));
    return hn::AllTrue(d, hn::Or(linear, hn::Le(hn::Mul(weight, cubic.Deviation()), most)));
  }

  HWY_INLINE void Step(Vector part, const Classified& next) {
    if (IsEmpty(next)) return;
    Add(part, next, Means(curve_, last_.classified, next));
  }
  /// The grey value's mean is `bend` above the straight line's.
  HWY_INLINE void Step(Vector part, const Classified& next, Vector bend) {
    if (IsEmpty(next)) return;
    Means means(curve_, last_.classified, next);
    means.Bend(curve_, last_.classified, next, bend);
    Add(part, next, means);
  }
  HWY_INLINE bool IsEmpty(const Classified& next) const {
    const Lanes d;
    const auto most = hn::Max(last_.classified.extinction, next.extinction);
    const auto same = hn::RebindMask(d, hn::Eq(last_.classified.segment, next.segment));
    return hn::AllTrue(d, hn::And(same, hn::Le(most, hn::Zero(d))));
  }
  HWY_INLINE void Add(Vector part, const Classified& next, const Means& means) {
    const Classified& last = last_.classified;
    const StepLight light(means.extinction, last.extinction, next.extinction, hn::Mul(rays_.mm_per_t, part));
    const auto before = hn::Mul(last.extinction, last.shade);
    const auto after = hn::Mul(next.extinction, next.shade);
    const auto through = sum_.Through();
    emitted_ = hn::MulAdd(through, light.Of(means.emission, before, after), emitted_);
    sum_.opacity = hn::MulAdd(through, light.Absorbed(), sum_.opacity);
  }

  const MarchScene& scene_;
  const Rays& rays_;
  Sum& sum_;
  const std::uint64_t* cell_corners_;
  Curve curve_;
  Vector emitted_;  // in the colour
  Taken last_;      // where the next step begins
  Ends ends_[2];    // of this stride, and of the one ahead
  int ahead_ = 0;   // which of them that is, and where it begins
  float ahead_from_ = -1e30f;
  bool valid_ = false;
};

}  // namespace splatlas::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // SPLATLAS_PLAYER_MARCH_SINGLE_APPEARANCE_INL_H_

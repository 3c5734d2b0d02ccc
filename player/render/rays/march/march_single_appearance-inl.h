// Ray marching through byte grey values with one transfer function, the common case. Grey values within cells
// are cubics in Bezier form. Compiled once for every instruction set.
#if defined(SPLATLAS_PLAYER_MARCH_SINGLE_APPEARANCE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SPLATLAS_PLAYER_MARCH_SINGLE_APPEARANCE_INL_H_
#undef SPLATLAS_PLAYER_MARCH_SINGLE_APPEARANCE_INL_H_
#else
#define SPLATLAS_PLAYER_MARCH_SINGLE_APPEARANCE_INL_H_
#endif

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include "player/render/rays/march/march_optics-inl.h"
#include "player/render/rays/march/march_packet-inl.h"
#include "player/render/rays/march/march_samples-inl.h"
#include "player/render/rays/march_kernels.h"

HWY_BEFORE_NAMESPACE();
namespace splatlas::HWY_NAMESPACE {

/// Outer rays of a packet of 4 x 4 pixels. Cells of the inner rays share cache lines with theirs.
constexpr std::size_t kOuterRays[] = {0, 1, 2, 3, 4, 7, 8, 11, 12, 13, 14, 15};

/// `Transfer`: ShortTransfer or LongTransfer.
template <typename Transfer>
class SingleAppearance {
 public:
  HWY_INLINE SingleAppearance(const MarchScene& scene, const Rays& rays, Accumulated& sum)
      : scene_(scene),
        rays_(rays),
        accumulated_(sum),
        cell_corners_(scene.sources[0].cell_corners),
        transfer_(*scene.sources[0].transfer),
        radiance_(Zero(Lanes())) {}

  /// The next batch does not begin at the end of the last one.
  HWY_INLINE void Invalidate() { valid_ = has_color_ = false; }

  /// Integrates kSlabs slabs from t on. Takes all samples first, so that memory accesses overlap.
  HWY_INLINE void MarchBatch(float t, const std::int32_t* /*from*/, const std::int32_t* /*to*/) {
    if (ahead_from_ != t) ends_[ahead_] = Ends(scene_.grid, rays_, t);
    const Ends& ends = ends_[ahead_];
    ahead_ = 1 - ahead_;
    LookAhead(t + static_cast<float>(kSlabs));
    auto at = rays_.Clamped(t);
    if (!valid_) last_ = Sample(Places(scene_.grid, rays_, at));
    valid_ = true;
    if (IsFaint()) {
      const Sampled sample = Sample(ends.places[kSlabs - 1]);
      Step(at, ends.t[kSlabs - 1], sample.classified);
      last_ = sample;
      return;
    }
    Sampled samples[kSlabs];
    for (std::size_t slab = 0; slab < kSlabs; ++slab) samples[slab] = Sample(ends.places[slab]);
    for (std::size_t slab = 0; slab < kSlabs; ++slab) {
      if (subdivides_cells(scene_)) {
        Slab(at, ends.t[slab], samples[slab]);
      } else {
        EvenSlab(at, ends.t[slab], samples[slab]);
      }
      last_ = samples[slab];
      at = ends.t[slab];
    }
  }

  HWY_INLINE void Finish() {
    for (std::size_t c = 0; c < 3; ++c) {
      const auto color = Set(Lanes(), scene_.sources[0].color[c]);
      accumulated_.color[c] = MulAdd(color, radiance_, accumulated_.color[c]);
    }
  }

 private:
  /// Ends of the slabs of a batch.
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
  struct Sampled {
    CellCorners cell_corners;
    Classified classified;
    IntVector cells;
  };
  HWY_INLINE Vector GreyAt(Vector t) const {
    const Places places(scene_.grid, rays_, t);
    return CellCorners(cell_corners_, places).Value(places);
  }
  HWY_INLINE Sampled Sample(const Places& places) const {
    const CellCorners cell_corners(cell_corners_, places);
    return {cell_corners, Classify(transfer_, cell_corners.Value(places)), Load(Ints(), places.cells)};
  }

  struct GreyRange {
    Vector low, high;
  };
  /// Range over the corners of all cells that the slab from `at` crosses; the last step ended at `at`.
  HWY_INLINE GreyRange RangeOf(Vector at, Vector end, const Sampled& sample) const {
    const auto between = rays_.CellsBetween(last_.cells, sample.cells, at, end);
    const CellCorners beside(cell_corners_, between.beside);
    if (HWY_LIKELY(!between.has_corner))
      return {beside.LowWith(last_.cell_corners, sample.cell_corners),
              beside.HighWith(last_.cell_corners, sample.cell_corners)};
    const CellCorners corner(cell_corners_, between.corner);
    return {corner.LowWith(beside, last_.cell_corners, sample.cell_corners),
            corner.HighWith(beside, last_.cell_corners, sample.cell_corners)};
  }

  /// Prefetches the cells of the next batch: hardware prefetchers do not predict them.
  HWY_INLINE void LookAhead(float t) {
    ends_[ahead_] = Ends(scene_.grid, rays_, t);
    ahead_from_ = t;
    for (const Places& places : ends_[ahead_].places) {
      for (const std::size_t ray : kOuterRays) hwy::Prefetch(cell_corners_ + places.cells[ray]);
    }
  }

  /// True if the transmittance is so low that one step integrates a batch.
  HWY_INLINE bool IsFaint() const {
    const Lanes d;
    const auto weight =
        Mul(Mul(accumulated_.Transmittance(), rays_.mm_per_t), Set(d, transfer_->variation()));
    return scene_.tolerance > 0 && AllTrue(d, Le(weight, Set(d, kFaintShare * scene_.tolerance)));
  }

  /// A slab in steps of equal lengths.
  HWY_INLINE void EvenSlab(Vector begin, Vector end, const Sampled& sample) {
    const auto length = Sub(end, begin);
    const int steps = Steps(begin, end, sample);
    auto at = begin;
    for (int n = 1; n < steps; ++n) {
      const auto next = PartOf(begin, length, n, steps);
      const Classified between = Classify(transfer_, GreyAt(next));
      Step(at, next, between);
      last_.classified = between;
      at = next;
    }
    Step(at, end, sample.classified);
  }

  /// Transmittance times segment length, mm.
  HWY_INLINE Vector WeightOf(Vector at, Vector end) const {
    return Mul(accumulated_.Transmittance(), Mul(rays_.mm_per_t, Sub(end, at)));
  }

  HWY_INLINE int Steps(Vector at, Vector end, const Sampled& sample) const {
    if (scene_.tolerance <= 0) return scene_.min_steps;
    const Lanes d;
    const auto weight = WeightOf(at, end);
    const auto upper_bound = Mul(weight, Set(d, transfer_->variation()));
    const auto limit = Set(d, kEvenShare * scene_.tolerance);
    if (AllTrue(d, Le(upper_bound, limit))) return scene_.min_steps;
    const GreyRange greys = RangeOf(at, end, sample);
    const auto low = VariationUpTo(transfer_, greys.low), high = VariationUpTo(transfer_, greys.high);
    return StepsOf(scene_, Mul(weight, Sub(high, low)));
  }

  /// A slab by its SlabMethod.
  HWY_INLINE void Slab(Vector at, Vector end, const Sampled& sample) {
    const Lanes d;
    const auto half = Set(d, 0.5f);
    switch (MethodFor(at, end, sample)) {
      case SlabMethod::kLinear: Step(at, end, sample.classified); break;
      case SlabMethod::kSimpson: {
        const auto straight = Mul(half, Add(last_.classified.grey, sample.classified.grey));
        const auto above = Sub(GreyAt(Mul(half, Add(at, end))), straight);
        Step(at, end, sample.classified, Mul(Set(d, kSimpsonShare), above));
        break;
      }
      case SlabMethod::kSubdivide: SubdivideSlab(at, end); break;
    }
  }

  HWY_INLINE SlabMethod MethodFor(Vector at, Vector end, const Sampled& sample) const {
    const Lanes d;
    const auto tolerance = Set(d, scene_.tolerance);
    const auto weight = WeightOf(at, end);
    const auto upper_bound = Mul(weight, Set(d, transfer_->variation()));
    if (AllTrue(d, Le(upper_bound, tolerance))) return SlabMethod::kLinear;
    const GreyRange greys = RangeOf(at, end, sample);
    const auto low_segment = SegmentOf(transfer_, greys.low), high_segment = SegmentOf(transfer_, greys.high);
    const auto low = VariationUpTo(transfer_, greys.low, low_segment);
    const auto high = VariationUpTo(transfer_, greys.high, high_segment);
    const auto varies = Mul(weight, Sub(high, low));
    if (AllTrue(d, Le(varies, tolerance))) return SlabMethod::kLinear;
    const auto limit = Mul(Set(d, kMaxVariation), tolerance);
    if (!AllTrue(d, Le(varies, limit))) return SlabMethod::kSubdivide;
    const auto middle = VariationUpTo(transfer_, Mul(Set(d, 0.5f), Add(greys.low, greys.high)));
    const auto kinks = Mul(weight, Abs(Sub(Add(low, high), Add(middle, middle))));
    const auto few = Le(kinks, Mul(Set(d, kMaxKinks), tolerance));
    const auto linear = RebindMask(d, Eq(low_segment, high_segment));
    return AllTrue(d, Or(few, linear)) ? SlabMethod::kSimpson : SlabMethod::kSubdivide;
  }

  HWY_NOINLINE void SubdivideSlab(Vector at, Vector end) {
    Vector cuts[3];
    Crossings(rays_, at, end, cuts);
    for (const Vector& cut : cuts) {
      if (!AllTrue(Lanes(), Le(cut, at))) SubdivideCell(at, cut);
      at = cut;
    }
  }

  /// Subdivides the cubic of a cell until its parts are straight enough.
  HWY_INLINE void SubdivideCell(Vector at, Vector end) {
    Cubic rest[kMaxSubdivisions + 1];  // parts ahead, the nearest last
    rest[0] = Cubic(cell_corners_, scene_.grid, rays_, at, end);
    std::size_t count = 1;
    while (count > 0) {
      Cubic& cubic = rest[count - 1];
      if (cubic.depth < kMaxSubdivisions && !IsStraight(Sub(cubic.t, at), cubic)) {
        rest[count++] = cubic.SplitFirstHalf(at);
        continue;
      }
      const Classified next = Classify(transfer_, cubic.points[3]);
      Step(at, cubic.t, next, cubic.MeanAboveChord());
      last_.classified = next;
      at = cubic.t;
      --count;
    }
  }

  HWY_INLINE bool IsStraight(Vector part, const Cubic& cubic) const {
    const Lanes d;
    const auto low = cubic.Low(), high = cubic.High();
    const auto low_segment = SegmentOf(transfer_, low), high_segment = SegmentOf(transfer_, high);
    const auto linear = RebindMask(d, Eq(low_segment, high_segment));
    if (AllTrue(d, linear)) return true;
    const auto variation =
        Sub(VariationUpTo(transfer_, high, high_segment), VariationUpTo(transfer_, low, low_segment));
    const auto weight = Mul(Mul(accumulated_.Transmittance(), Mul(rays_.mm_per_t, part)), variation);
    const auto limit = Mul(Set(d, kMaxShift * scene_.tolerance), Sub(high, low));
    return AllTrue(d, Or(linear, Le(Mul(weight, cubic.Deviation()), limit)));
  }

  HWY_INLINE void Step(Vector at, Vector end, const Classified& next) {
    if (SkipsEmpty(next)) return;
    Composite(at, end, next, PreintegratedMeans(transfer_, last_.classified, next));
  }
  /// For a mean grey value that lies `shift` above the chord.
  HWY_INLINE void Step(Vector at, Vector end, const Classified& next, Vector shift) {
    if (SkipsEmpty(next)) return;
    PreintegratedMeans means(transfer_, last_.classified, next);
    means.ShiftGrey(transfer_, last_.classified, next, shift);
    Composite(at, end, next, means);
  }
  HWY_INLINE bool SkipsEmpty(const Classified& next) {
    const Lanes d;
    const auto limit = Max(last_.classified.extinction, next.extinction);
    const auto same = RebindMask(d, Eq(last_.classified.segment, next.segment));
    const bool is_empty = AllTrue(d, And(same, Le(limit, Zero(d))));
    has_color_ = has_color_ && !is_empty;
    return is_empty;
  }

  HWY_INLINE void Composite(Vector at, Vector end, const Classified& next, const PreintegratedMeans& means) {
    if (HWY_LIKELY(scene_.sources[0].colors == nullptr)) {
      const SegmentRadiance radiance = RadianceOf(at, end, next, means);
      radiance_ =
          MulAdd(accumulated_.Transmittance(),
                 radiance.Of(means.emission, EmissionOf(last_.classified), EmissionOf(next)), radiance_);
      AddOpacity(at, end, radiance);
    } else {
      CompositeColors(at, end, next, means);
    }
  }
  static HWY_INLINE Vector EmissionOf(const Classified& c) { return Mul(c.extinction, c.shade); }
  HWY_INLINE SegmentRadiance RadianceOf(Vector at, Vector end, const Classified& next,
                                        const PreintegratedMeans& means) const {
    return {means.extinction, last_.classified.extinction, next.extinction,
            Mul(rays_.mm_per_t, Sub(end, at))};
  }
  HWY_INLINE void AddOpacity(Vector at, Vector end, const SegmentRadiance& radiance) {
    accumulated_.opacity = MulAdd(accumulated_.Transmittance(), radiance.Opacity(), accumulated_.opacity);
    accumulated_.Record(at, end);
  }

  HWY_INLINE VoxelColor ColorAt(Vector t) const { return {scene_.sources[0].colors, scene_.grid, rays_, t}; }

  /// A step with a colour for each voxel: that in the middle, or a step that is halved.
  HWY_NOINLINE void CompositeColors(Vector at, Vector end, const Classified& next,
                                    const PreintegratedMeans& means) {
    const Lanes d;
    const VoxelColor middle = ColorAt(Mul(Set(d, 0.5f), Add(at, end)));
    const SegmentRadiance radiance = RadianceOf(at, end, next, means);
    const auto transmittance = accumulated_.Transmittance();
    const auto faint = Set(d, kFaintColor * scene_.tolerance);
    if (!subdivides_cells(scene_) || AllTrue(d, Le(Mul(transmittance, radiance.Opacity()), faint))) {
      const auto of_white = radiance.Of(means.emission, EmissionOf(last_.classified), EmissionOf(next));
      const auto weight = Mul(transmittance, of_white);
      for (std::size_t n = 0; n < 3; ++n)
        accumulated_.color[n] = MulAdd(weight, middle.of[n], accumulated_.color[n]);
      AddOpacity(at, end, radiance);
      has_color_ = false;
      return;
    }
    const VoxelColor before = has_color_ ? color_ : ColorAt(at);
    color_ = ColorAt(end);
    has_color_ = true;
    CompositeHalves(at, end, {before, middle, color_}, next, means, 0);
  }

  /// Colours at the beginning, in the middle, and at the end of a step.
  struct StepColors {
    VoxelColor before, middle, after;

    /// Height of the middle above the straight line between the ends.
    [[nodiscard]] HWY_INLINE Vector Above(std::size_t n) const {
      return NegMulAdd(Set(Lanes(), 0.5f), Add(before.of[n], after.of[n]), middle.of[n]);
    }
  };

  /// Halves a step until its colour is nearly linear, or nearly constant where the extinction changes.
  HWY_NOINLINE void CompositeHalves(Vector at, Vector end, const StepColors& colors, const Classified& next,
                                    const PreintegratedMeans& means, int depth) {
    const Lanes d;
    const Classified& last = last_.classified;
    const SegmentRadiance radiance = RadianceOf(at, end, next, means);
    const auto transmittance = accumulated_.Transmittance();
    const auto half = Set(d, 0.5f);
    const auto both = Add(last.extinction, next.extinction);
    const auto per_both = Div(Set(d, 1.0f), Max(both, Set(d, 1e-30f)));
    const auto uneven = Mul(half, Mul(per_both, Abs(Sub(next.extinction, last.extinction))));
    auto error = Zero(d);
    for (std::size_t n = 0; n < 3; ++n) {
      const auto rise = Abs(Sub(colors.after.of[n], colors.before.of[n]));
      error = Max(error, Max(Abs(colors.Above(n)), Mul(uneven, rise)));
    }
    error = Mul(error, Mul(transmittance, radiance.Opacity()));
    if (depth < kMaxHalvings && !AllTrue(d, Le(error, Set(d, kColorShare * scene_.tolerance)))) {
      const auto middle = Mul(half, Add(at, end));
      const Classified there = Classify(transfer_, GreyAt(middle));
      const PreintegratedMeans first(transfer_, last, there), second(transfer_, there, next);
      CompositeHalves(at, middle, {colors.before, ColorAt(Mul(half, Add(at, middle))), colors.middle}, there,
                      first, depth + 1);
      last_.classified = there;
      CompositeHalves(middle, end, {colors.middle, ColorAt(Mul(half, Add(middle, end))), colors.after}, next,
                      second, depth + 1);
      return;
    }

    // The mean of a linear colour, weighted by a linear extinction
    const auto third = Set(d, 1.0f / 3);
    const auto share =
        IfThenElse(Gt(both, Zero(d)), Mul(Mul(third, per_both), Add(both, next.extinction)), half);
    for (std::size_t n = 0; n < 3; ++n) {
      const auto before = colors.before.of[n], after = colors.after.of[n];
      const auto straight = MulAdd(share, Sub(after, before), before);
      const auto mean = MulAdd(Set(d, kSimpsonShare), colors.Above(n), straight);
      const auto of_color =
          radiance.Of(Mul(mean, means.emission), Mul(before, EmissionOf(last)), Mul(after, EmissionOf(next)));
      accumulated_.color[n] = MulAdd(transmittance, of_color, accumulated_.color[n]);
    }
    AddOpacity(at, end, radiance);
  }

  const MarchScene& scene_;
  const Rays& rays_;
  Accumulated& accumulated_;
  const std::uint64_t* cell_corners_;
  Transfer transfer_;
  Vector radiance_;  // per unit of the colour; 0 with one for each voxel
  Sampled last_;     // at the beginning of the next step
  Ends ends_[2];     // of this batch and the next
  int ahead_ = 0;    // index of the next batch, which begins at `ahead_from_`
  float ahead_from_ = -1e30f;
  bool valid_ = false;
  VoxelColor color_;  // at the beginning of the next step
  bool has_color_ = false;
};

}  // namespace splatlas::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // SPLATLAS_PLAYER_MARCH_SINGLE_APPEARANCE_INL_H_

// Grey values along rays within cells as cubics in Bezier form. Compiled once for every instruction set.
#if defined(SPLATLAS_PLAYER_MARCH_CUBICS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SPLATLAS_PLAYER_MARCH_CUBICS_INL_H_
#undef SPLATLAS_PLAYER_MARCH_CUBICS_INL_H_
#else
#define SPLATLAS_PLAYER_MARCH_CUBICS_INL_H_
#endif

#include <hwy/highway.h>

#include "player/render/rays/march/march_packet-inl.h"
#include "player/render/rays/march/march_samples-inl.h"
#include "player/render/rays/march_kernels.h"

HWY_BEFORE_NAMESPACE();
namespace splatlas::HWY_NAMESPACE {

/// Crossings of cell faces between `at` and `end` in ascending order, padded with `end` (Amanatides and Woo
/// 1987). The interval spans at most one voxel along every axis and crosses no plane of the principal axis.
HWY_INLINE void Crossings(const Rays& rays, Vector at, Vector end, Vector* cuts) {
  const Lanes d;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto step = rays.step[a];
    const auto place = rays.At(a, end);
    const auto plane = IfThenElse(Gt(step, Zero(d)), Floor(place), Ceil(place));
    const auto t = Mul(Sub(plane, rays.origin[a]), rays.t_per_voxel[a]);
    const auto none = Or(Le(t, at), Ge(t, end));
    cuts[a] = IfThenElse(none, end, t);
  }
  const auto low = Min(cuts[0], cuts[1]), high = Max(cuts[0], cuts[1]);
  const auto rest = Max(low, cuts[2]);
  cuts[0] = Min(low, cuts[2]);
  cuts[1] = Min(rest, high);
  cuts[2] = end;
}

/// A trilinear grey value along rays within a cell: a cubic in Bezier form, up to `t`.
struct Cubic {
  Vector points[4], t;
  int depth = 0;  // of subdivision

  Cubic() = default;
  /// From `at` to `end`, which lie in one cell.
  HWY_INLINE Cubic(const std::uint64_t* cell_corners, const MarchGrid& grid, const Rays& rays, Vector at,
                   Vector end)
      : t(end) {
    const auto middle = Mul(Set(Lanes(), 0.5f), Add(at, end));
    const Places places(grid, rays, middle);  // rounding cannot leave the cell there
    const auto half = Sub(end, middle);
    Vector before[3], after[3];
    for (std::size_t a = 0; a < 3; ++a) {
      before[a] = NegMulAdd(half, rays.step[a], places.part[a]);
      after[a] = MulAdd(half, rays.step[a], places.part[a]);
    }
    CellCorners(cell_corners, places).ControlPoints(before, after, points);
  }

  /// Splits at the middle (de Casteljau). Returns the first half, which begins at `at`; keeps the second.
  HWY_INLINE Cubic SplitFirstHalf(Vector at) {
    const auto middle = [](Vector a, Vector b) { return Mul(Set(Lanes(), 0.5f), Add(a, b)); };
    Cubic first;
    first.points[0] = points[0];
    first.points[1] = middle(points[0], points[1]);
    const auto inner = middle(points[1], points[2]);
    first.points[2] = middle(first.points[1], inner);
    points[2] = middle(points[2], points[3]);
    points[1] = middle(inner, points[2]);
    points[0] = first.points[3] = middle(first.points[2], points[1]);
    first.t = middle(at, t);
    first.depth = ++depth;
    return first;
  }

  /// Bounds of the value, by the convex hull of the control points.
  HWY_INLINE Vector Low() const { return Min(Min(points[0], points[1]), Min(points[2], points[3])); }
  HWY_INLINE Vector High() const { return Max(Max(points[0], points[1]), Max(points[2], points[3])); }
  /// Bound of the distance from the chord.
  HWY_INLINE Vector Deviation() const {
    const auto third = Mul(Set(Lanes(), 1.0f / 3), Sub(points[3], points[0]));
    const auto first = Sub(Sub(points[1], points[0]), third);
    const auto second = Sub(Sub(points[3], points[2]), third);
    return Max(Abs(first), Abs(second));
  }
  /// Mean value less the mean of the chord.
  HWY_INLINE Vector MeanAboveChord() const {
    const auto inner = Add(points[1], points[2]), outer = Add(points[0], points[3]);
    return Mul(Set(Lanes(), 0.25f), Sub(inner, outer));
  }
};

}  // namespace splatlas::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // SPLATLAS_PLAYER_MARCH_CUBICS_INL_H_

// The grey value along rays, cell by cell: cubics. Compiled once for every instruction set.
#if defined(SPLATLAS_PLAYER_MARCH_CUBICS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SPLATLAS_PLAYER_MARCH_CUBICS_INL_H_
#undef SPLATLAS_PLAYER_MARCH_CUBICS_INL_H_
#else
#define SPLATLAS_PLAYER_MARCH_CUBICS_INL_H_
#endif

#include <hwy/highway.h>

#include "player/rays/march_kernels.h"
#include "player/rays/march_packet-inl.h"
#include "player/rays/march_samples-inl.h"

HWY_BEFORE_NAMESPACE();
namespace splatlas::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Where rays pass from cell to cell between `at` and `end`, no more than one plane of voxels along any axis
/// apart, and none inside along the one that t counts: in order, `end` where there is none, and last.
HWY_INLINE void Crossings(const Rays& rays, Vector at, Vector end, Vector* cuts) {
  const Lanes d;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto step = rays.step[a];
    const auto place = rays.At(a, end);
    const auto plane = hn::IfThenElse(hn::Gt(step, hn::Zero(d)), hn::Floor(place), hn::Ceil(place));
    const auto t = hn::Mul(hn::Sub(plane, rays.origin[a]), rays.t_per_voxel[a]);
    const auto none = hn::Or(hn::Le(t, at), hn::Ge(t, end));
    cuts[a] = hn::IfThenElse(none, end, t);
  }
  const auto low = hn::Min(cuts[0], cuts[1]), high = hn::Max(cuts[0], cuts[1]);
  const auto rest = hn::Max(low, cuts[2]);
  cuts[0] = hn::Min(low, cuts[2]);
  cuts[1] = hn::Min(rest, high);
  cuts[2] = end;
}

/// The grey value along rays within a cell: its control points up to `t`.
struct Cubic {
  Vector points[4], t;
  int halvings = 0;

  Cubic() = default;
  /// From `at` to `end`, which lie in one cell.
  HWY_INLINE Cubic(const std::uint64_t* cell_corners, const MarchGrid& grid, const Rays& rays, Vector at,
                   Vector end)
      : t(end) {
    const auto middle = hn::Mul(hn::Set(Lanes(), 0.5f), hn::Add(at, end));
    const Places places(grid, rays, middle);  // there the cell is certain
    const auto half = hn::Sub(end, middle);
    Vector before[3], after[3];
    for (std::size_t a = 0; a < 3; ++a) {
      before[a] = hn::NegMulAdd(half, rays.step[a], places.part[a]);
      after[a] = hn::MulAdd(half, rays.step[a], places.part[a]);
    }
    CellCorners(cell_corners, places).ControlPoints(before, after, points);
  }

  /// The first half, from `at` on; the second one stays.
  HWY_INLINE Cubic SplitFirstHalf(Vector at) {
    const auto middle = [](Vector a, Vector b) { return hn::Mul(hn::Set(Lanes(), 0.5f), hn::Add(a, b)); };
    Cubic first;
    first.points[0] = points[0];
    first.points[1] = middle(points[0], points[1]);
    const auto inner = middle(points[1], points[2]);
    first.points[2] = middle(first.points[1], inner);
    points[2] = middle(points[2], points[3]);
    points[1] = middle(inner, points[2]);
    points[0] = first.points[3] = middle(first.points[2], points[1]);
    first.t = middle(at, t);
    first.halvings = ++halvings;
    return first;
  }

  /// No value lies beyond these.
  HWY_INLINE Vector Low() const {
    return hn::Min(hn::Min(points[0], points[1]), hn::Min(points[2], points[3]));
  }
  HWY_INLINE Vector High() const {
    return hn::Max(hn::Max(points[0], points[1]), hn::Max(points[2], points[3]));
  }
  /// No value is further off the straight line between the ends.
  HWY_INLINE Vector Deviation() const {
    const auto third = hn::Mul(hn::Set(Lanes(), 1.0f / 3), hn::Sub(points[3], points[0]));
    const auto first = hn::Sub(hn::Sub(points[1], points[0]), third);
    const auto second = hn::Sub(hn::Sub(points[3], points[2]), third);
    return hn::Max(hn::Abs(first), hn::Abs(second));
  }
  /// Its mean less that of the straight line between the ends.
  HWY_INLINE Vector Bend() const {
    const auto inner = hn::Add(points[1], points[2]), outer = hn::Add(points[0], points[3]);
    return hn::Mul(hn::Set(Lanes(), 0.25f), hn::Sub(inner, outer));
  }
};

}  // namespace splatlas::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // SPLATLAS_PLAYER_MARCH_CUBICS_INL_H_

// Packets of rays, and empty-space skipping by bricks. Compiled once for every instruction set.
#if defined(SPLATLAS_PLAYER_MARCH_PACKET_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SPLATLAS_PLAYER_MARCH_PACKET_INL_H_
#undef SPLATLAS_PLAYER_MARCH_PACKET_INL_H_
#else
#define SPLATLAS_PLAYER_MARCH_PACKET_INL_H_
#endif

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include <hwy/highway.h>

#include "player/render/rays/march_kernels.h"
#include "player/render/simd/wide_vector-inl.h"

HWY_BEFORE_NAMESPACE();
namespace splatlas::HWY_NAMESPACE {

using Lanes = WideTag<float, kPacketRays>;
using Ints = SignedTag<Lanes>;
using Bits = UnsignedTag<Lanes>;
using Vector = WideVec<Lanes>;
using IntVector = WideVec<Ints>;
using BitVector = WideVec<Bits>;
using Mask = WideMask<Lanes>;
using IntMask = WideMask<Ints>;

/// Rays of a packet, clipped to one voxel around the selected voxels.
struct Rays {
  Vector origin[3], step[3], mm_per_t, from, to;
  Vector t_per_voxel[3];  // very large where a ray does not move
  // Distances between neighbouring cells: along the principal axis, and along the two minor axes.
  IntVector layer, across[2];
  IntMask ascends;  // along the principal axis

  HWY_INLINE Rays(const MarchGrid& grid, const RayPacket& packet) {
    const Lanes d;
    from = Load(d, packet.from.data());
    to = Load(d, packet.to.data());
    for (std::size_t a = 0; a < 3; ++a) {
      origin[a] = Load(d, packet.origin[a].data());
      step[a] = Load(d, packet.step[a].data());
      t_per_voxel[a] = Inverse(step[a]);
      Clip(a, static_cast<float>(grid.size[a]) - 2.0f);
    }
    mm_per_t = Load(d, packet.mm_per_t.data());
    FindLayers(grid);
    const auto misses = Not(Counts());
    from = IfThenZeroElse(misses, from);
    to = IfThenZeroElse(misses, to);
    for (std::size_t a = 0; a < 3; ++a) {  // rays that miss stay at a valid position
      origin[a] = IfThenElse(misses, Set(d, 1.0f), origin[a]);
      step[a] = IfThenZeroElse(misses, step[a]);
    }
  }
  HWY_INLINE Mask Counts() const { return Lt(from, to); }
  HWY_INLINE Vector Clamped(float t) const { return Min(Max(Set(Lanes(), t), from), to); }
  HWY_INLINE Vector At(std::size_t axis, Vector t) const { return MulAdd(step[axis], t, origin[axis]); }

  /// Cells crossed between the two end cells of a slab: one edge neighbour, and one more when the ray steps
  /// along both minor axes within the slab.
  struct Between {
    IntVector beside;
    IntVector corner;  // any cell of the slab for rays without one
    bool has_corner;   // for any ray
  };

  /// `begin`, `end`: the cells at `t0` and `t1`, the ends of a slab.
  HWY_INLINE Between CellsBetween(IntVector begin, IntVector end, Vector t0, Vector t1) const {
    const Ints di;
    const auto none = Zero(di);
    const auto beside = Max(Sub(IfThenElse(ascends, end, begin), layer), none);
    const auto ends_within = IsDiagonal(Sub(end, begin));
    const auto first = IfThenElse(Or(ends_within, ascends), begin, beside);
    const auto last = IfThenElse(Or(ends_within, Not(ascends)), end, beside);
    const auto distance = Sub(last, first);
    const auto has_corner = IsDiagonal(distance);
    if (HWY_LIKELY(AllFalse(di, has_corner))) return {beside, beside, false};
    const auto along_1 = IfThenElse(Lt(distance, none), Sub(none, across[1]), across[1]);
    const auto along_1_first = RebindMask(di, Lt(CrossingOf(1, t0, t1), CrossingOf(0, t0, t1)));
    const auto corner = IfThenElse(along_1_first, Add(first, along_1), Sub(last, along_1));
    const auto in_box = Min(Max(corner, none), last_cell_);
    return {beside, IfThenElse(has_corner, in_box, beside), true};
  }

 private:
  /// The t at which a ray crosses from cell to cell along a minor axis, if it does so once.
  HWY_INLINE Vector CrossingOf(std::size_t other, Vector t0, Vector t1) const {
    const auto before = MulAdd(across_step_[other], t0, across_origin_[other]);
    const auto behind = MulAdd(across_step_[other], t1, across_origin_[other]);
    const auto plane = Max(Floor(before), Floor(behind));
    return Mul(Sub(plane, across_origin_[other]), t_per_across_[other]);
  }
  /// True if cells `distance` apart are neighbours along both minor axes. False without a principal axis.
  HWY_INLINE IntMask IsDiagonal(IntVector distance) const {
    const auto cells = Abs(distance);
    const auto apart = Sub(across[1], across[0]), together = Add(across[1], across[0]);
    return And(Gt(together, apart), Or(Eq(cells, apart), Eq(cells, together)));
  }

  HWY_INLINE void FindLayers(const MarchGrid& grid) {
    const Lanes d;
    const Ints di;
    const std::int32_t strides[3] = {1, grid.size[0], grid.size[0] * grid.size[1]};
    last_cell_ = Set(di, strides[2] * grid.size[2] - 1);
    layer = across[0] = across[1] = Zero(di);
    for (std::size_t other = 0; other < 2; ++other)
      across_origin_[other] = across_step_[other] = t_per_across_[other] = Zero(d);
    ascends = MaskFromVec(Zero(di));
    for (std::size_t a = 0; a < 3; ++a) {
      const auto is_unit = Eq(Abs(step[a]), Set(d, 1.0f));
      const auto counts = RebindMask(di, And(is_unit, Eq(origin[a], Zero(d))));
      layer = IfThenElse(counts, Set(di, strides[a]), layer);
      const auto is_principal = RebindMask(d, counts);
      const std::size_t others[2] = {a == 0 ? 1u : 0u, a == 2 ? 1u : 2u};
      for (std::size_t other = 0; other < 2; ++other) {
        const std::size_t axis = others[other];
        across[other] = IfThenElse(counts, Set(di, strides[axis]), across[other]);
        across_origin_[other] = IfThenElse(is_principal, origin[axis], across_origin_[other]);
        across_step_[other] = IfThenElse(is_principal, step[axis], across_step_[other]);
        t_per_across_[other] = IfThenElse(is_principal, t_per_voxel[axis], t_per_across_[other]);
      }
      const auto up = RebindMask(di, Gt(step[a], Zero(d)));
      ascends = MaskFromVec(IfThenElse(counts, VecFromMask(di, up), VecFromMask(di, ascends)));
    }
  }
  static HWY_INLINE Vector Inverse(Vector per_t) {
    const Lanes d;
    const auto tiny = Set(d, 1e-20f);
    return Div(Set(d, 1.0f), IfThenElse(Lt(Abs(per_t), tiny), tiny, per_t));
  }
  HWY_INLINE void Clip(std::size_t axis, float last) {
    const Lanes d;
    const auto low = Mul(Sub(Set(d, 1.0f), origin[axis]), t_per_voxel[axis]);
    const auto high = Mul(Sub(Set(d, last), origin[axis]), t_per_voxel[axis]);
    from = Max(from, Min(low, high));
    to = Min(to, Max(low, high));
  }

  IntVector last_cell_;
  // Along the minor axes.
  Vector across_origin_[2], across_step_[2], t_per_across_[2];
};

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

/// The end of the n-th of equal steps.
HWY_INLINE Vector PartOf(Vector begin, Vector length, int n, int steps) {
  return MulAdd(Set(Lanes(), static_cast<float>(n) / static_cast<float>(steps)), length, begin);
}

/// True if a box of bricks, both ends included, has an active one: O(1) by the summed-area table.
HWY_INLINE bool AnyActive(const std::uint32_t* sums, const MarchGrid& grid, const std::int32_t* first,
                          const std::int32_t* last) {
  const std::int64_t row = grid.bricks(0) + 1;
  const std::int64_t slice = row * (grid.bricks(1) + 1);
  const auto sum = [&](std::int64_t x, std::int64_t y, std::int64_t z) {
    return sums[z * slice + y * row + x];
  };
  const auto plane = [&](std::int64_t z) {
    return sum(last[0] + 1, last[1] + 1, z) - sum(first[0], last[1] + 1, z) - sum(last[0] + 1, first[1], z) +
           sum(first[0], first[1], z);
  };
  return plane(last[2] + 1) != plane(first[2]);
}

/// Bounds of a packet along each axis, linear in t. The minimum of straight lines is concave and lies above
/// its chords; the maximum lies below its chords.
struct Bounds {
  float first = 0;
  float low[3] = {0, 0, 0}, low_step[3] = {0, 0, 0};
  float high[3] = {0, 0, 0}, high_step[3] = {0, 0, 0};

  HWY_INLINE Bounds(const Rays& rays, Mask counts, float from, float to) : first(from) {
    const Lanes d;
    const auto beyond = Set(d, 1e30f);
    const float scale = 1.0f / (to - from);
    for (std::size_t a = 0; a < 3; ++a) {
      const auto start = rays.At(a, Set(d, from));
      const auto end = rays.At(a, Set(d, to));
      low[a] = MinLane(d, IfThenElse(counts, start, beyond));
      high[a] = MaxLane(d, IfThenElse(counts, start, Neg(beyond)));
      low_step[a] = (MinLane(d, IfThenElse(counts, end, beyond)) - low[a]) * scale;
      high_step[a] = (MaxLane(d, IfThenElse(counts, end, Neg(beyond))) - high[a]) * scale;
    }
  }

  /// Bricks that the packet may cross from t0 to t1, padded for rounding.
  HWY_INLINE void Bricks(const MarchGrid& grid, float t0, float t1, std::int32_t* from,
                         std::int32_t* to) const {
    constexpr float kRounding = 1.0f / 64;
    for (std::size_t a = 0; a < 3; ++a) {
      const float min = low[a] + std::min(low_step[a] * (t0 - first), low_step[a] * (t1 - first));
      const float max = high[a] + std::max(high_step[a] * (t0 - first), high_step[a] * (t1 - first));
      const auto end = static_cast<float>(grid.size[a] - 1);
      from[a] = static_cast<std::int32_t>(std::clamp(min - kRounding, 0.0f, end)) / MarchGrid::kBrick;
      to[a] = static_cast<std::int32_t>(std::clamp(max + kRounding, 0.0f, end)) / MarchGrid::kBrick;
    }
  }
};

}  // namespace splatlas::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // SPLATLAS_PLAYER_MARCH_PACKET_INL_H_

// Rays in vectors, and the bricks that they come by. Compiled once for every instruction set.
#if defined(SPLATLAS_PLAYER_MARCH_PACKET_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SPLATLAS_PLAYER_MARCH_PACKET_INL_H_
#undef SPLATLAS_PLAYER_MARCH_PACKET_INL_H_
#else
#define SPLATLAS_PLAYER_MARCH_PACKET_INL_H_
#endif

#include <hwy/highway.h>

#include "player/rays/march_kernels.h"

HWY_BEFORE_NAMESPACE();
namespace splatlas::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::CappedTag<float, kPacketRays>;
using Ints = hn::RebindToSigned<Lanes>;
using Bits = hn::RebindToUnsigned<Lanes>;
using Vector = hn::Vec<Lanes>;
using IntVector = hn::Vec<Ints>;

/// The rays of a packet that fit a vector, as far as they are within one voxel of the voxels.
struct Rays {
  Vector origin[3], step[3], mm_per_t, from, to;
  Vector t_per_voxel[3];  // very large where a ray does not move
  // Cells from one to the next: along the axis that t counts, and along both others.
  IntVector layer, across[2];
  hn::Mask<Ints> ascends;  // along that axis

  HWY_INLINE Rays(const MarchGrid& grid, const RayPacket& packet, std::size_t first) {
    const Lanes d;
    from = hn::Load(d, packet.from.data() + first);
    to = hn::Load(d, packet.to.data() + first);
    for (std::size_t a = 0; a < 3; ++a) {
      origin[a] = hn::Load(d, packet.origin[a].data() + first);
      step[a] = hn::Load(d, packet.step[a].data() + first);
      t_per_voxel[a] = Inverse(step[a]);
      Clip(a, static_cast<float>(grid.size[a]) - 2.0f);
    }
    mm_per_t = hn::Load(d, packet.mm_per_t.data() + first);
    FindLayers(grid);
    const auto misses = hn::Not(Counts());
    from = hn::IfThenZeroElse(misses, from);
    to = hn::IfThenZeroElse(misses, to);
    for (std::size_t a = 0; a < 3; ++a) {  // wait where nothing is
      origin[a] = hn::IfThenElse(misses, hn::Set(d, 1.0f), origin[a]);
      step[a] = hn::IfThenZeroElse(misses, step[a]);
    }
  }
  HWY_INLINE hn::Mask<Lanes> Counts() const { return hn::Lt(from, to); }
  HWY_INLINE Vector Clamped(float t) const { return hn::Min(hn::Max(hn::Set(Lanes(), t), from), to); }
  HWY_INLINE Vector At(std::size_t axis, Vector t) const { return hn::MulAdd(step[axis], t, origin[axis]); }

  /// The cells of a slab that neither end is in. It lies in one layer of cells, its further end in a cell of
  /// the next: there is the one beside that in the slab's own layer; and where it goes on by one cell along
  /// both other axes, the one that it comes by on its way.
  struct Between {
    IntVector beside;
    IntVector corner;  // any of the slab's where a ray has none
    bool has_corner;   // any ray
  };

  /// `begin`, `end`: the cells where a slab is at `t0` and `t1`.
  HWY_INLINE Between CellsBetween(IntVector begin, IntVector end, Vector t0, Vector t1) const {
    const Ints di;
    const auto none = hn::Zero(di);
    const auto beside = hn::Max(hn::Sub(hn::IfThenElse(ascends, end, begin), layer), none);
    const auto ends_within = IsDiagonal(hn::Sub(end, begin));
    const auto first = hn::IfThenElse(hn::Or(ends_within, ascends), begin, beside);
    const auto last = hn::IfThenElse(hn::Or(ends_within, hn::Not(ascends)), end, beside);
    const auto way = hn::Sub(last, first);
    const auto has_corner = IsDiagonal(way);
    if (HWY_LIKELY(hn::AllFalse(di, has_corner))) return {beside, beside, false};
    const auto along_1 = hn::IfThenElse(hn::Lt(way, none), hn::Sub(none, across[1]), across[1]);
    const auto along_1_first = hn::RebindMask(di, hn::Lt(Passes(1, t0, t1), Passes(0, t0, t1)));
    const auto corner = hn::IfThenElse(along_1_first, hn::Add(first, along_1), hn::Sub(last, along_1));
    const auto in_box = hn::Min(hn::Max(corner, none), last_cell_);
    return {beside, hn::IfThenElse(has_corner, in_box, beside), true};
  }

 private:
  /// Where a ray passes from cell to cell along one of both other axes, if it does so once.
  HWY_INLINE Vector Passes(std::size_t other, Vector t0, Vector t1) const {
    const auto before = hn::MulAdd(across_step_[other], t0, across_origin_[other]);
    const auto behind = hn::MulAdd(across_step_[other], t1, across_origin_[other]);
    const auto plane = hn::Max(hn::Floor(before), hn::Floor(behind));
    return hn::Mul(hn::Sub(plane, across_origin_[other]), t_per_across_[other]);
  }
  /// Of the way from cell to cell: one along both other axes, which rays without a principal axis do not
  /// have.
  HWY_INLINE hn::Mask<Ints> IsDiagonal(IntVector way) const {
    const auto cells = hn::Abs(way);
    const auto apart = hn::Sub(across[1], across[0]), together = hn::Add(across[1], across[0]);
    return hn::And(hn::Gt(together, apart), hn::Or(hn::Eq(cells, apart), hn::Eq(cells, together)));
  }

  HWY_INLINE void FindLayers(const MarchGrid& grid) {
    const Lanes d;
    const Ints di;
    const std::int32_t strides[3] = {1, grid.size[0], grid.size[0] * grid.size[1]};
    last_cell_ = hn::Set(di, strides[2] * grid.size[2] - 1);
    layer = across[0] = across[1] = hn::Zero(di);
    for (std::size_t other = 0; other < 2; ++other)
      across_origin_[other] = across_step_[other] = t_per_across_[other] = hn::Zero(d);
    ascends = hn::MaskFromVec(hn::Zero(di));
    for (std::size_t a = 0; a < 3; ++a) {
      const auto is_unit = hn::Eq(hn::Abs(step[a]), hn::Set(d, 1.0f));
      const auto counts = hn::RebindMask(di, hn::And(is_unit, hn::Eq(origin[a], hn::Zero(d))));
      layer = hn::IfThenElse(counts, hn::Set(di, strides[a]), layer);
      const auto is_principal = hn::RebindMask(d, counts);
      const std::size_t others[2] = {a == 0 ? 1u : 0u, a == 2 ? 1u : 2u};
      for (std::size_t other = 0; other < 2; ++other) {
        const std::size_t axis = others[other];
        across[other] = hn::IfThenElse(counts, hn::Set(di, strides[axis]), across[other]);
        across_origin_[other] = hn::IfThenElse(is_principal, origin[axis], across_origin_[other]);
        across_step_[other] = hn::IfThenElse(is_principal, step[axis], across_step_[other]);
        t_per_across_[other] = hn::IfThenElse(is_principal, t_per_voxel[axis], t_per_across_[other]);
      }
      const auto up = hn::RebindMask(di, hn::Gt(step[a], hn::Zero(d)));
      ascends =
          hn::MaskFromVec(hn::IfThenElse(counts, hn::VecFromMask(di, up), hn::VecFromMask(di, ascends)));
    }
  }
  static HWY_INLINE Vector Inverse(Vector per_t) {
    const Lanes d;
    const auto tiny = hn::Set(d, 1e-20f);
    return hn::Div(hn::Set(d, 1.0f), hn::IfThenElse(hn::Lt(hn::Abs(per_t), tiny), tiny, per_t));
  }
  HWY_INLINE void Clip(std::size_t axis, float last) {
    const Lanes d;
    const auto low = hn::Mul(hn::Sub(hn::Set(d, 1.0f), origin[axis]), t_per_voxel[axis]);
    const auto high = hn::Mul(hn::Sub(hn::Set(d, last), origin[axis]), t_per_voxel[axis]);
    from = hn::Max(from, hn::Min(low, high));
    to = hn::Min(to, hn::Max(low, high));
  }

  IntVector last_cell_;
  // Along both other axes.
  Vector across_origin_[2], across_step_[2], t_per_across_[2];
};

/// Where the n-th of equal steps ends.
HWY_INLINE Vector PartOf(Vector begin, Vector length, int n, int steps) {
  return hn::MulAdd(hn::Set(Lanes(), static_cast<float>(n) / static_cast<float>(steps)), length, begin);
}

/// Active bricks in a box of bricks, both ends included.
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

/// Bounds of a packet's rays along one axis, linear in t: what is smallest of several straight lines lies
/// above the chord between any two of its points, what is largest below.
struct Bounds {
  float first = 0;
  float low[3] = {0, 0, 0}, low_step[3] = {0, 0, 0};
  float high[3] = {0, 0, 0}, high_step[3] = {0, 0, 0};

  HWY_INLINE Bounds(const Rays& rays, hn::Mask<Lanes> counts, float from, float to) : first(from) {
    const Lanes d;
    const auto most = hn::Set(d, 1e30f);
    const float scale = 1.0f / (to - from);
    for (std::size_t a = 0; a < 3; ++a) {
      const auto start = rays.At(a, hn::Set(d, from));
      const auto end = rays.At(a, hn::Set(d, to));
      low[a] = hn::GetLane(hn::MinOfLanes(d, hn::IfThenElse(counts, start, most)));
      high[a] = hn::GetLane(hn::MaxOfLanes(d, hn::IfThenElse(counts, start, hn::Neg(most))));
      low_step[a] = (hn::GetLane(hn::MinOfLanes(d, hn::IfThenElse(counts, end, most))) - low[a]) * scale;
      high_step[a] =
          (hn::GetLane(hn::MaxOfLanes(d, hn::IfThenElse(counts, end, hn::Neg(most)))) - high[a]) * scale;
    }
  }

  /// Bricks from t0 to t1, with room for rounding.
  HWY_INLINE void Bricks(const MarchGrid& grid, float t0, float t1, std::int32_t* from,
                         std::int32_t* to) const {
    constexpr float kRounding = 1.0f / 64;
    for (std::size_t a = 0; a < 3; ++a) {
      const float least = low[a] + std::min(low_step[a] * (t0 - first), low_step[a] * (t1 - first));
      const float most = high[a] + std::max(high_step[a] * (t0 - first), high_step[a] * (t1 - first));
      const auto end = static_cast<float>(grid.size[a] - 1);
      from[a] = static_cast<std::int32_t>(std::clamp(least - kRounding, 0.0f, end)) / MarchGrid::kBrick;
      to[a] = static_cast<std::int32_t>(std::clamp(most + kRounding, 0.0f, end)) / MarchGrid::kBrick;
    }
  }
};

}  // namespace splatlas::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // SPLATLAS_PLAYER_MARCH_PACKET_INL_H_

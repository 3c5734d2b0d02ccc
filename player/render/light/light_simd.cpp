// Kernels that light voxels. Highway compiles this file once for every instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "player/render/light/light_simd.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include <cstddef>
#include <cstdint>

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include "player/render/light/voxel_light.h"

HWY_BEFORE_NAMESPACE();
namespace splatlas::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using F = hn::CappedTag<float, kLightPadding>;
using I = hn::RebindToSigned<F>;
using U16 = hn::Rebind<std::uint16_t, F>;
using Floats = hn::Vec<F>;
using Ints = hn::Vec<I>;

/// Sums over the pairs of a weight.
struct Pairs {
  Floats pairs, differences, squares;

  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init)
  HWY_INLINE Pairs() { pairs = differences = squares = hn::Zero(F()); }
  HWY_INLINE void Add(hn::Mask<F> counts, Floats low, Floats high) {
    const Floats difference = hn::IfThenElseZero(counts, hn::Sub(high, low));
    pairs = hn::Add(pairs, hn::IfThenElseZero(counts, hn::Set(F(), 1)));
    differences = hn::Add(differences, difference);
    squares = hn::Add(squares, hn::Mul(difference, difference));
  }
  /// Adds other sums with a weight.
  HWY_INLINE void Add(const Pairs& other, float weight) {
    const Floats w = hn::Set(F(), weight);
    pairs = hn::Add(pairs, hn::Mul(w, other.pairs));
    differences = hn::Add(differences, hn::Mul(w, other.differences));
    squares = hn::Add(squares, hn::Mul(w, other.squares));
  }
  HWY_INLINE void Store(const PairSums& sums, std::size_t n) const {
    hn::StoreU(pairs, F(), sums.pairs + n);
    hn::StoreU(differences, F(), sums.differences + n);
    hn::StoreU(squares, F(), sums.squares + n);
  }
};

/// Sums over the pairs of the rows around positions [-1, count + 1).
HWY_INLINE void SumPairs(const GreyRows& rows, std::size_t count, const std::array<PairSums, 3>& sums) {
  const F d;
  for (std::size_t n = 0; n < count + 2; n += hn::Lanes(d)) {
    const auto value = [&](std::size_t k, int ahead) { return hn::LoadU(d, rows.values[k] + n - 1 + ahead); };
    const auto counts = [&](std::size_t k, int ahead) {
      return hn::Eq(hn::LoadU(I(), rows.structures[k] + n - 1 + ahead), hn::Set(I(), rows.structure));
    };
    const auto add = [&](std::size_t low, std::size_t high, int ahead, Pairs& pairs) {
      pairs.Add(hn::RebindMask(d, hn::And(counts(low, 0), counts(high, ahead))), value(low, 0),
                value(high, ahead));
    };
    {
      Pairs middle, beside, corners;
      add(4, 4, 1, middle);
      for (const std::size_t k : {1, 3, 5, 7}) add(k, k, 1, beside);
      for (const std::size_t k : {0, 2, 6, 8}) add(k, k, 1, corners);
      middle.Add(beside, 0.5f);
      middle.Add(corners, 0.25f);
      middle.Store(sums[0], n);
    }
    for (const std::size_t axis : {1, 2}) {  // rows, slices
      const std::size_t next = axis == 1 ? 1 : 3, across = 4 - next;
      Pairs middle, beside;
      for (const std::size_t low : {std::size_t{0}, next}) {
        add(low + across, low + across + next, 0, middle);
        add(low, low + next, 0, beside);
        add(low + 2 * across, low + 2 * across + next, 0, beside);
      }
      middle.Add(beside, 0.5f);
      middle.Store(sums[axis], n);
    }
  }
}

/// 0 up to `low`, 1 from `high` on, linear between them; 0 for NaN.
HWY_INLINE Floats Ramp(Floats x, float low, float high) {
  const F d;
  const Floats share = hn::Div(hn::Sub(x, hn::Set(d, low)), hn::Set(d, high - low));
  return hn::IfThenElseZero(hn::Gt(share, hn::Zero(d)), hn::Min(share, hn::Set(d, 1)));
}

/// A gradient along an axis, from the sums at the positions before, at and after each voxel.
struct Gradient {
  Floats mean, square;

  HWY_INLINE Gradient(const PairSums& sums, std::size_t n, bool along) {
    const F d;
    const auto around = [&](const float* at) {
      const Floats before = hn::LoadU(d, at + n), here = hn::LoadU(d, at + n + 1);
      if (along) return hn::Add(before, here);
      return hn::Add(here, hn::Mul(hn::Set(d, 0.5f), hn::Add(before, hn::LoadU(d, at + n + 2))));
    };
    const Floats pairs = hn::Max(around(sums.pairs), hn::Set(d, 1e-30f));
    const Floats per_pair = hn::Div(hn::Set(d, 1), pairs);
    mean = hn::Mul(around(sums.differences), per_pair);
    square = hn::Mul(around(sums.squares), per_pair);
  }
};

void MeasureGradient(const GreyRows& rows, std::size_t count, const GradientScale& scale,
                     const std::array<PairSums, 3>& sums, const GradientRow& out) {
  constexpr float kNoise = 0.3f, kClear = 0.6f;
  const F d;
  SumPairs(rows, count, sums);
  for (std::size_t n = 0; n < count; n += hn::Lanes(d)) {
    Floats lengths = hn::Zero(d), squares = hn::Zero(d);
    Floats direction[3] = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Gradient along(sums[axis], n, axis == 0);
      const Floats per_mm_squared = hn::Set(d, scale.per_mm_squared[axis]);
      lengths = hn::Add(lengths, hn::Mul(hn::Mul(along.mean, along.mean), per_mm_squared));
      squares = hn::Add(squares, hn::Mul(along.square, per_mm_squared));
      for (std::size_t b = 0; b < 3; ++b)
        direction[b] = hn::Add(direction[b], hn::Mul(along.mean, hn::Set(d, scale.to_lps[axis][b])));
    }
    for (std::size_t b = 0; b < 3; ++b) hn::StoreU(direction[b], d, out.direction[b] + n);
    const Floats coherence = hn::Div(lengths, hn::Max(squares, hn::Set(d, 1e-30f)));
    hn::StoreU(Ramp(coherence, kNoise, kClear), d, out.coherence + n);
    hn::StoreU(hn::Mul(hn::Set(d, scale.reach_mm), hn::Sqrt(lengths)), d, out.reach + n);
  }
}

struct Vectors {
  Floats x, y, z;
};

HWY_INLINE Floats SignOf(Floats x) {
  const F d;
  return hn::IfThenElse(hn::Lt(x, hn::Zero(d)), hn::Set(d, -1), hn::Set(d, 1));
}

/// Exchanges the lower half of the octahedron and the outside of the square of its upper half.
HWY_INLINE void Fold(hn::Mask<F> is_lower, Floats& p, Floats& q) {
  const Floats one = hn::Set(F(), 1);
  const Floats folded_p = hn::Mul(hn::Sub(one, hn::Abs(q)), SignOf(p));
  const Floats folded_q = hn::Mul(hn::Sub(one, hn::Abs(p)), SignOf(q));
  p = hn::IfThenElse(is_lower, folded_p, p);
  q = hn::IfThenElse(is_lower, folded_q, q);
}

constexpr float kCodes = 127;

/// As unpack_normal().
HWY_INLINE Vectors Unpack(const PackedNormal* packed) {
  const F d;
  const I di;
  const Ints codes = hn::PromoteTo(di, hn::LoadU(U16(), packed));
  const auto component = [&](Ints code) {
    return hn::Max(hn::Div(hn::ConvertTo(d, code), hn::Set(d, kCodes)), hn::Set(d, -1));
  };
  Floats x = component(hn::ShiftRight<24>(hn::ShiftLeft<24>(codes)));
  Floats y = component(hn::ShiftRight<24>(hn::ShiftLeft<16>(codes)));
  const Floats z = hn::Sub(hn::Sub(hn::Set(d, 1), hn::Abs(x)), hn::Abs(y));
  Fold(hn::Lt(z, hn::Zero(d)), x, y);
  const Floats squares = hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z));
  const Floats length = hn::Sqrt(squares);
  return {hn::Div(x, length), hn::Div(y, length), hn::Div(z, length)};
}

/// Packs vectors of any length, each component of the map rounded by itself.
HWY_INLINE void Pack(const Vectors& v, PackedNormal* packed) {
  const F d;
  const I di;
  const Floats sum = hn::Add(hn::Add(hn::Abs(v.x), hn::Abs(v.y)), hn::Abs(v.z));
  const Floats per_sum = hn::Div(hn::Set(d, 1), hn::Max(sum, hn::Set(d, 1e-30f)));
  Floats p = hn::Mul(v.x, per_sum), q = hn::Mul(v.y, per_sum);
  Fold(hn::Lt(v.z, hn::Zero(d)), p, q);
  const auto code = [&](Floats at) {  // also for NaN
    const Floats at_most_1 = hn::IfThenElse(hn::Lt(at, hn::Set(d, 1)), at, hn::Set(d, 1));
    const Floats in_range = hn::IfThenElse(hn::Gt(at_most_1, hn::Set(d, -1)), at_most_1, hn::Set(d, -1));
    const Floats above_0 = hn::Add(hn::Mul(in_range, hn::Set(d, kCodes)), hn::Set(d, kCodes + 0.5f));
    const Ints rounded = hn::Sub(hn::ConvertTo(di, above_0), hn::Set(di, static_cast<std::int32_t>(kCodes)));
    return hn::And(rounded, hn::Set(di, 0xff));
  };
  const Ints codes = hn::Or(code(p), hn::ShiftLeft<8>(code(q)));
  hn::StoreU(hn::DemoteTo(U16(), codes), U16(), packed);
}

HWY_INLINE Vectors Direction(const GradientRow& gradients, std::size_t n) {
  const F d;
  return {hn::LoadU(d, gradients.direction[0] + n), hn::LoadU(d, gradients.direction[1] + n),
          hn::LoadU(d, gradients.direction[2] + n)};
}

HWY_INLINE Floats Dot(const Vectors& a, const Vectors& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}

void FindExtinctions(const TransferTable::View& table, const float* greys, const float* reach,
                     std::size_t count, float* below, float* above) {
  static_assert(sizeof(TransferShare) == 2 * sizeof(float));  // the extinction and another
  const F d;
  const I di;
  const float* const shares = &table.shares.front().extinction;
  const Ints mask = hn::Set(di, static_cast<std::int32_t>(table.shares.size() - 1));
  const Floats lowest = hn::Set(d, table.lowest), highest = hn::Set(d, table.highest);
  const auto at = [&](Ints value) {
    return hn::GatherIndex(d, shares, hn::ShiftLeft<1>(hn::And(value, mask)));
  };
  const auto extinction = [&](Floats grey) {
    const Floats in_range = hn::Min(hn::Max(grey, lowest), highest), whole = hn::Floor(in_range);
    const Ints place = hn::ConvertTo(di, whole);
    const Ints step = hn::IfThenElseZero(hn::RebindMask(di, hn::Lt(whole, highest)), hn::Set(di, 1));
    const Floats here = at(place), next = at(hn::Add(place, step));
    return hn::Add(here, hn::Mul(hn::Sub(in_range, whole), hn::Sub(next, here)));
  };
  for (std::size_t n = 0; n < count; n += hn::Lanes(d)) {
    const Floats grey = hn::LoadU(d, greys + n), by = hn::LoadU(d, reach + n);
    hn::StoreU(extinction(hn::Sub(grey, by)), d, below + n);
    hn::StoreU(extinction(hn::Add(grey, by)), d, above + n);
  }
}

/// Borders: the label's normal, replaced by the gradient as far as both have one direction.
HWY_INLINE Vectors LightBorder(const Vectors& label, const Vectors& gradient, Floats coherence) {
  constexpr float kAcross = 0.3f, kAlong = 0.8f;
  const F d;
  const Floats squares = hn::Max(Dot(gradient, gradient), hn::Set(d, 1e-30f));
  const Floats per_length = hn::Div(hn::Set(d, 1), hn::Sqrt(squares));
  const Floats cosine = hn::Mul(Dot(gradient, label), per_length);
  const Floats share = hn::Mul(coherence, Ramp(hn::Abs(cosine), kAcross, kAlong));
  const Floats of_gradient = hn::Mul(hn::Mul(share, SignOf(cosine)), per_length);
  const Floats of_label = hn::Sub(hn::Set(d, 1), share);
  const auto agree = hn::Gt(share, hn::Zero(d));  // false for overflows
  const auto mixed = [&](Floats of_grey, Floats border) {
    const Floats mix = hn::Add(hn::Mul(of_gradient, of_grey), hn::Mul(of_label, border));
    return hn::IfThenElse(agree, mix, border);
  };
  return {mixed(gradient.x, label.x), mixed(gradient.y, label.y), mixed(gradient.z, label.z)};
}

void Light(const float* below, const float* above, std::size_t count, const GradientRow& gradients,
           const LightRow& voxels) {
  constexpr float kFlat = 0.01f, kSteep = 0.05f;
  const F d;
  const I di;
  const Floats all_lit = hn::Set(d, 65535);
  for (std::size_t n = 0; n < count; n += hn::Lanes(d)) {
    const Floats lit_before = hn::ConvertTo(d, hn::PromoteTo(di, hn::LoadU(U16(), voxels.lit + n)));
    const auto is_border = hn::Eq(lit_before, all_lit);
    const Vectors gradient = Direction(gradients, n);
    const Floats coherence = hn::LoadU(d, gradients.coherence + n);
    // Others: towards lower extinctions, lit where these change
    const Floats low = hn::LoadU(d, below + n), high = hn::LoadU(d, above + n);
    const Floats densest = hn::Max(low, high);
    const Floats change = hn::Div(hn::AbsDiff(high, low), hn::Max(densest, hn::Set(d, 1e-30f)));
    const Floats share = hn::IfThenElseZero(hn::Gt(densest, hn::Zero(d)), Ramp(change, kFlat, kSteep));
    const Floats lit = hn::Add(hn::Mul(hn::Mul(coherence, share), all_lit), hn::Set(d, 0.5f));
    const Floats sign = hn::IfThenElse(hn::Gt(high, low), hn::Set(d, -1), hn::Set(d, 1));
    Vectors normal{hn::Mul(gradient.x, sign), hn::Mul(gradient.y, sign), hn::Mul(gradient.z, sign)};
    if (!hn::AllFalse(d, is_border)) {
      const Vectors border = LightBorder(Unpack(voxels.normals + n), gradient, coherence);
      normal = {hn::IfThenElse(is_border, border.x, normal.x), hn::IfThenElse(is_border, border.y, normal.y),
                hn::IfThenElse(is_border, border.z, normal.z)};
    }
    Pack(normal, voxels.normals + n);
    const Ints of_voxels = hn::ConvertTo(di, hn::IfThenElse(is_border, all_lit, lit));
    hn::StoreU(hn::DemoteTo(U16(), of_voxels), U16(), voxels.lit + n);
  }
}

void Emit(const UnlitBlocks& blocks, const float* factors, float* lit) {
  const F d;
  const I di;
  const Floats one = hn::Set(d, 1), per_share = hn::Set(d, 1.0f / VoxelLight::kAllLit);
  const auto floats = static_cast<std::size_t>(kBlock) * static_cast<std::size_t>(1 + blocks.emissions);
  std::uint32_t next = 0;
  const auto copy_up_to = [&](std::uint32_t end) {
    std::copy(blocks.optics + next * floats, blocks.optics + end * floats, lit + next * floats);
    next = end;
  };
  for (const BlockLights& of_block : blocks.lights) {
    copy_up_to(of_block.block - blocks.first);
    const float* const from = blocks.optics + next * floats;
    float* const to = lit + next * floats;
    constexpr std::size_t kAhead = 8;
    for (std::size_t line = 0; line < floats; line += 16) hwy::Prefetch(from + kAhead * floats + line);
    hwy::Prefetch(&of_block + kAhead);
    for (std::size_t n = 0; n < kBlock; n += hn::Lanes(d)) {
      const Ints light = hn::LoadU(di, reinterpret_cast<const std::int32_t*>(of_block.lights.data() + n));
      const Ints share = hn::BitCast(di, hn::ShiftRight<16>(hn::BitCast(hn::RebindToUnsigned<I>(), light)));
      const Floats factor = hn::GatherIndex(d, factors, hn::And(light, hn::Set(di, 0xffff)));
      const Floats of_unlit =
          hn::Add(one, hn::Mul(hn::Mul(hn::ConvertTo(d, share), per_share), hn::Sub(factor, one)));
      hn::Store(hn::Load(d, from + n), d, to + n);
      for (std::size_t at = kBlock + n; at < floats; at += kBlock)
        hn::Store(hn::Mul(hn::Load(d, from + at), of_unlit), d, to + at);
    }
    ++next;
  }
  copy_up_to(blocks.count);
}

}  // namespace splatlas::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "player/render/simd/simd_choice.h"

namespace splatlas {

HWY_EXPORT(MeasureGradient);
HWY_EXPORT(FindExtinctions);
HWY_EXPORT(Light);
HWY_EXPORT(Emit);

LightKernels light_kernels() {
  static_cast<void>(best_target());  // applies SPLATLAS_SIMD
  return {HWY_DYNAMIC_DISPATCH(MeasureGradient), HWY_DYNAMIC_DISPATCH(FindExtinctions),
          HWY_DYNAMIC_DISPATCH(Light), HWY_DYNAMIC_DISPATCH(Emit)};
}

}  // namespace splatlas
#endif  // HWY_ONCE

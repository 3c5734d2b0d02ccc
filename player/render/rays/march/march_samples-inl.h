// Trilinear samples of grey values and optical properties. Compiled once for every instruction set.
#if defined(SPLATLAS_PLAYER_MARCH_SAMPLES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SPLATLAS_PLAYER_MARCH_SAMPLES_INL_H_
#undef SPLATLAS_PLAYER_MARCH_SAMPLES_INL_H_
#else
#define SPLATLAS_PLAYER_MARCH_SAMPLES_INL_H_
#endif

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include <hwy/highway.h>

#include "player/render/rays/march/march_packet-inl.h"
#include "player/render/rays/march_kernels.h"

HWY_BEFORE_NAMESPACE();
namespace splatlas::HWY_NAMESPACE {

/// Positions on rays: the cell and the fractional coordinates within it.
struct Places {
  HWY_ALIGN std::int32_t cells[kPacketRays];
  Vector part[3];

  Places() = default;
  HWY_INLINE Places(const MarchGrid& grid, const Rays& rays, Vector t) {
    const Lanes d;
    const Ints di;
    IntVector whole[3];
    for (std::size_t a = 0; a < 3; ++a) {
      const auto at = rays.At(a, t);  // a margin of one voxel absorbs rounding
      whole[a] = ConvertTo(di, at);
      part[a] = Sub(at, ConvertTo(d, whole[a]));
    }
    const auto row = Add(Mul(whole[2], Set(di, grid.size[1])), whole[1]);
    Store(Add(Mul(row, Set(di, grid.size[0])), whole[0]), di, cells);
  }
};

HWY_INLINE Vector Lerp(Vector a, Vector b, Vector part) {
  return MulAdd(part, Sub(b, a), a);
}

template <int kByte>
HWY_INLINE Vector Byte(BitVector bits) {
  const Bits du;
  const auto byte = And(ShiftBitsRight<8 * kByte>(bits), Set(du, 255u));
  return ConvertTo(Lanes(), BitCast(Ints(), byte));
}

/// Bilinear in the four bytes of a face of a cell.
HWY_INLINE Vector Face(BitVector bits, const Places& places) {
  const auto low = Lerp(Byte<0>(bits), Byte<1>(bits), places.part[0]);
  const auto high = Lerp(Byte<2>(bits), Byte<3>(bits), places.part[0]);
  return Lerp(low, high, places.part[1]);
}

/// The lower and the upper halves of 64-bit words.
template <class V>
struct SplitWords {
  V lower, upper;
};

#if HWY_TARGET == HWY_SCALAR

template <class D>
HWY_INLINE SplitWords<hn::Vec<D>> LoadWords(D d, const std::uint64_t* words, const std::int32_t* indices) {
  const std::uint64_t word = words[*indices];
  return {hn::Set(d, static_cast<std::uint32_t>(word)), hn::Set(d, static_cast<std::uint32_t>(word >> 32))};
}

/// Byte by byte.
template <class V, class Choose>
HWY_INLINE V ChooseBytes(V a, V b, const Choose& choose) {
  V chosen(0);
  for (int bit = 0; bit < 32; bit += 8) chosen.raw |= choose(a.raw >> bit & 255, b.raw >> bit & 255) << bit;
  return chosen;
}
template <class V>
HWY_INLINE V MinBytes(V a, V b) {
  return ChooseBytes(a, b, [](std::uint32_t x, std::uint32_t y) { return std::min(x, y); });
}
template <class V>
HWY_INLINE V MaxBytes(V a, V b) {
  return ChooseBytes(a, b, [](std::uint32_t x, std::uint32_t y) { return std::max(x, y); });
}

#else

/// A native vector of words: single loads cost less than a gather.
template <std::size_t kCount>
HWY_INLINE hn::Vec<hn::FixedTag<std::uint64_t, kCount>> GatherWords(const std::uint64_t* words,
                                                                    const std::int32_t* indices) {
  const hn::FixedTag<std::uint64_t, kCount> d;
  if constexpr (kCount == 1) {
    return hn::LoadU(d, words + indices[0]);
  } else {
    return hn::Combine(d, GatherWords<kCount / 2>(words, indices + kCount / 2),
                       GatherWords<kCount / 2>(words, indices));
  }
}

template <class D>
HWY_INLINE SplitWords<hn::Vec<D>> LoadWords(D d, const std::uint64_t* words, const std::int32_t* indices) {
  constexpr std::size_t kHalf = hn::MaxLanes(D()) / 2;  // words are twice as wide as lanes
  const auto first = hn::BitCast(d, GatherWords<kHalf>(words, indices));
  const auto second = hn::BitCast(d, GatherWords<kHalf>(words, indices + kHalf));
  return {hn::ConcatEven(d, second, first), hn::ConcatOdd(d, second, first)};
}

template <class V>
HWY_INLINE V MinBytes(V a, V b) {
  const hn::Repartition<std::uint8_t, hn::DFromV<V>> bytes;
  return hn::BitCast(hn::DFromV<V>(), hn::Min(hn::BitCast(bytes, a), hn::BitCast(bytes, b)));
}
template <class V>
HWY_INLINE V MaxBytes(V a, V b) {
  const hn::Repartition<std::uint8_t, hn::DFromV<V>> bytes;
  return hn::BitCast(hn::DFromV<V>(), hn::Max(hn::BitCast(bytes, a), hn::BitCast(bytes, b)));
}

#endif  // HWY_TARGET == HWY_SCALAR

template <class D>
HWY_INLINE SplitWords<WideVec<PairTag<D>>> LoadWords(PairTag<D>, const std::uint64_t* words,
                                                     const std::int32_t* indices) {
  const auto low = LoadWords(D(), words, indices), high = LoadWords(D(), words, indices + kLanesOf<D>);
  return {{low.lower, high.lower}, {low.upper, high.upper}};
}
template <class V>
HWY_INLINE Pair<V> MinBytes(const Pair<V>& a, const Pair<V>& b) {
  return {MinBytes(a.low, b.low), MinBytes(a.high, b.high)};
}
template <class V>
HWY_INLINE Pair<V> MaxBytes(const Pair<V>& a, const Pair<V>& b) {
  return {MaxBytes(a.low, b.low), MaxBytes(a.high, b.high)};
}

/// The grey values of the eight corners of cells, a byte each: front faces and back faces.
struct CellCorners {
  BitVector front, back;

  CellCorners() = default;
  HWY_INLINE CellCorners(const std::uint64_t* corners, const Places& places)
      : CellCorners(corners, places.cells) {}
  HWY_INLINE CellCorners(const std::uint64_t* corners, IntVector cells) {
    HWY_ALIGN std::int32_t stored[kPacketRays];
    Store(cells, Ints(), stored);
    *this = CellCorners(corners, stored);
  }
  HWY_INLINE CellCorners(const std::uint64_t* corners, const std::int32_t* cells) {
    const auto faces = LoadWords(Bits(), corners, cells);
    front = faces.lower;
    back = faces.upper;
  }

  HWY_INLINE Vector Value(const Places& places) const {
    return Lerp(Face(front, places), Face(back, places), places.part[2]);
  }
  /// Bezier control points of the cubic that a trilinear value is along the segment from `a` to `b`
  /// (fractional coordinates): the blossom at (a, a, a), (a, a, b), (a, b, b) and (b, b, b).
  HWY_INLINE void ControlPoints(const Vector* a, const Vector* b, Vector* points) const {
    Vector fronts[4], backs[4];  // at (a, a), (b, a), (a, b), (b, b) along x and y
    FaceCorners(front, a, b, fronts);
    FaceCorners(back, a, b, backs);
    const auto third = Set(Lanes(), 1.0f / 3);
    points[0] = Lerp(fronts[0], backs[0], a[2]);
    points[3] = Lerp(fronts[3], backs[3], b[2]);
    const auto aab = Lerp(fronts[0], backs[0], b[2]);
    const auto ones = Add(Lerp(fronts[1], backs[1], a[2]), Lerp(fronts[2], backs[2], a[2]));
    points[1] = Mul(third, Add(aab, ones));
    const auto bba = Lerp(fronts[3], backs[3], a[2]);
    const auto twos = Add(Lerp(fronts[1], backs[1], b[2]), Lerp(fronts[2], backs[2], b[2]));
    points[2] = Mul(third, Add(bba, twos));
  }

  /// The lowest grey value among the corners of these cells and others.
  template <typename... Others>
  HWY_INLINE Vector LowWith(const Others&... others) const {
    auto low = MinBytes(front, back);
    ((low = MinBytes(low, MinBytes(others.front, others.back))), ...);
    low = MinBytes(low, ShiftBitsRight<16>(low));
    return Byte<0>(MinBytes(low, ShiftBitsRight<8>(low)));
  }
  template <typename... Others>
  HWY_INLINE Vector HighWith(const Others&... others) const {
    auto high = MaxBytes(front, back);
    ((high = MaxBytes(high, MaxBytes(others.front, others.back))), ...);
    high = MaxBytes(high, ShiftBitsRight<16>(high));
    return Byte<0>(MaxBytes(high, ShiftBitsRight<8>(high)));
  }

 private:
  /// Bilinear in the bytes of a face, at (a, a), (b, a), (a, b) and (b, b).
  static HWY_INLINE void FaceCorners(BitVector bits, const Vector* a, const Vector* b, Vector* corners) {
    const auto low = Byte<0>(bits), high = Byte<2>(bits);
    const auto low_step = Sub(Byte<1>(bits), low), high_step = Sub(Byte<3>(bits), high);
    const auto low_a = MulAdd(a[0], low_step, low), low_b = MulAdd(b[0], low_step, low);
    const auto step_a = Sub(MulAdd(a[0], high_step, high), low_a);
    const auto step_b = Sub(MulAdd(b[0], high_step, high), low_b);
    corners[0] = MulAdd(a[1], step_a, low_a);
    corners[1] = MulAdd(a[1], step_b, low_b);
    corners[2] = MulAdd(b[1], step_a, low_a);
    corners[3] = MulAdd(b[1], step_b, low_b);
  }
};

/// A trilinear grey value, and the minimum and maximum of the eight corners around it.
struct Grey {
  Vector value, low, high;
};

HWY_INLINE Grey SampleCellCorners(const std::uint64_t* corners, const Places& places) {
  const CellCorners cells(corners, places);
  return {cells.Value(places), cells.LowWith(), cells.HighWith()};
}

/// `Mix`: (a, b, part of b).
template <class Mix>
HWY_INLINE Grey SampleGreys(const float* greys, const MarchGrid& grid, const Places& places, const Mix& mix) {
  const Lanes d;
  const std::ptrdiff_t row = grid.size[0];
  const std::ptrdiff_t slice = row * grid.size[1];
  const auto cell = Load(Ints(), places.cells);
  Grey grey{Zero(d), GatherIndex(d, greys, cell), Zero(d)};
  grey.high = grey.low;
  const auto edge = [&](std::ptrdiff_t offset) HWY_ATTR {
    const auto left = GatherIndex(d, greys + offset, cell);
    const auto right = GatherIndex(d, greys + offset + 1, cell);
    grey.low = Min(grey.low, Min(left, right));
    grey.high = Max(grey.high, Max(left, right));
    return mix(left, right, places.part[0]);
  };
  const auto front = mix(edge(0), edge(row), places.part[1]);
  const auto back = mix(edge(slice), edge(slice + row), places.part[1]);
  grey.value = mix(front, back, places.part[2]);
  return grey;
}

/// Extends a range by the four corners of the face that cells begin with: a voxel and its neighbours
/// `across`. Voxels have `kEach` values, of which the first counts.
template <std::ptrdiff_t kEach>
HWY_INLINE void WidenByFace(const float* values, IntVector cells, const IntVector* across, Vector& low,
                            Vector& high) {
  const Ints di;
  HWY_ALIGN std::int32_t voxels[kPacketRays];
  HWY_ALIGN std::int32_t right[kPacketRays];
  HWY_ALIGN std::int32_t below[kPacketRays];
  HWY_ALIGN float lows[kPacketRays];
  HWY_ALIGN float highs[kPacketRays];
  Store(cells, di, voxels);
  Store(across[0], di, right);
  Store(across[1], di, below);
  for (std::size_t n = 0; n < kPacketRays; ++n) {
    const float* const upper = values + kEach * voxels[n];
    const float* const lower = upper + kEach * below[n];
    const std::ptrdiff_t beside = kEach * right[n];
    lows[n] = std::min(std::min(*upper, upper[beside]), std::min(*lower, lower[beside]));
    highs[n] = std::max(std::max(*upper, upper[beside]), std::max(*lower, lower[beside]));
  }
  low = Min(low, Load(Lanes(), lows));
  high = Max(high, Load(Lanes(), highs));
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

/// Four interpolated values, each a vector.
struct Four {
  Vector of[4];
};

/// Samples four values per voxel at the positions of a packet, ray by ray.
class FourSampler {
 public:
  HWY_INLINE FourSampler(const float* fours, const MarchGrid& grid, const Places& places)
      : fours_(fours), row_(std::ptrdiff_t{4} * grid.size[0]), slice_(row_ * grid.size[1]) {
    std::copy_n(places.cells, kPacketRays, cells_);
    for (std::size_t a = 0; a < 3; ++a) Store(places.part[a], Lanes(), parts_[a]);
  }

  HWY_INLINE Four Between() const {
    HWY_ALIGN float samples[4 * kPacketRays];
    for (std::size_t n = 0; n < kPacketRays; ++n) {
      const float* corner = fours_ + std::ptrdiff_t{4} * cells_[n];
      const auto front = Mix(Edge(corner, n), Edge(corner + row_, n), parts_[1][n]);
      const auto back = Mix(Edge(corner + slice_, n), Edge(corner + slice_ + row_, n), parts_[1][n]);
      Store(Mix(front, back, parts_[2][n]), OneTag(), samples + 4 * n);
    }
    Four four;
    LoadInterleaved4(Lanes(), samples, four.of[0], four.of[1], four.of[2], four.of[3]);
    return four;
  }

  /// The minimum and maximum of the first value among the eight corners.
  HWY_INLINE void Range(Vector& low, Vector& high) const {
    HWY_ALIGN float lows[kPacketRays];
    HWY_ALIGN float highs[kPacketRays];
    for (std::size_t n = 0; n < kPacketRays; ++n) {
      const float* corner = fours_ + std::ptrdiff_t{4} * cells_[n];
      lows[n] = highs[n] = corner[0];
      for (const std::ptrdiff_t voxel :
           {std::ptrdiff_t{4}, row_, row_ + 4, slice_, slice_ + 4, slice_ + row_, slice_ + row_ + 4}) {
        lows[n] = std::min(lows[n], corner[voxel]);
        highs[n] = std::max(highs[n], corner[voxel]);
      }
    }
    low = Load(Lanes(), lows);
    high = Load(Lanes(), highs);
  }

 private:
  using OneTag = WideTag<float, 4>;
  using OneVector = WideVec<OneTag>;

  /// Written as a sum of non-negative terms, which avoids cancellation: colours are divided by their weight.
  static HWY_INLINE OneVector Mix(OneVector a, OneVector b, float part) {
    return FusedMulAdd(OneTag(), Set(OneTag(), part), b, Mul(Set(OneTag(), 1 - part), a));
  }
  HWY_INLINE OneVector Edge(const float* corner, std::size_t n) const {
    return Mix(LoadU(OneTag(), corner), LoadU(OneTag(), corner + 4), parts_[0][n]);
  }

  const float* fours_;
  std::ptrdiff_t row_, slice_;
  HWY_ALIGN std::int32_t cells_[kPacketRays];
  HWY_ALIGN float parts_[3][kPacketRays];
};

/// Colours of voxels at positions along rays, weighted by their presence.
struct VoxelColor {
  Vector of[3];

  VoxelColor() = default;
  HWY_INLINE VoxelColor(const float* colors, const MarchGrid& grid, const Rays& rays, Vector at) {
    const Lanes d;
    const Places places(grid, rays, at);
    const Four sampled = FourSampler(colors, grid, places).Between();
    const auto share = Div(Set(d, 1.0f), Max(sampled.of[3], Set(d, 1e-12f)));
    for (std::size_t n = 0; n < 3; ++n) of[n] = Mul(share, sampled.of[n]);
  }
};

}  // namespace splatlas::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // SPLATLAS_PLAYER_MARCH_SAMPLES_INL_H_

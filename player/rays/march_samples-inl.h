// What rays sample: grey values and light between voxels. Compiled once for every instruction set.
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

#include "player/rays/march_kernels.h"
#include "player/rays/march_packet-inl.h"

HWY_BEFORE_NAMESPACE();
namespace splatlas::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Cells, and where in them.
struct Places {
  HWY_ALIGN std::int32_t cells[hn::MaxLanes(Lanes())];
  Vector part[3];

  Places() = default;
  HWY_INLINE Places(const MarchGrid& grid, const Rays& rays, Vector t) {
    const Lanes d;
    const Ints di;
    IntVector whole[3];
    for (std::size_t a = 0; a < 3; ++a) {
      const auto at = rays.At(a, t);  // a whole voxel of margin is left for rounding
      whole[a] = hn::ConvertTo(di, at);
      part[a] = hn::Sub(at, hn::ConvertTo(d, whole[a]));
    }
    const auto row = hn::Add(hn::Mul(whole[2], hn::Set(di, grid.size[1])), whole[1]);
    hn::Store(hn::Add(hn::Mul(row, hn::Set(di, grid.size[0])), whole[0]), di, cells);
  }
};

HWY_INLINE Vector Lerp(Vector a, Vector b, Vector part) {
  return hn::MulAdd(part, hn::Sub(b, a), a);
}

template <int kByte>
HWY_INLINE Vector Byte(hn::Vec<Bits> bits) {
  const Bits du;
  const auto byte = hn::And(hn::ShiftRight<8 * kByte>(bits), hn::Set(du, 255));
  return hn::ConvertTo(Lanes(), hn::BitCast(Ints(), byte));
}

/// Bilinear in the four bytes of a face of a cell.
HWY_INLINE Vector Face(hn::Vec<Bits> bits, const Places& places) {
  const auto low = Lerp(Byte<0>(bits), Byte<1>(bits), places.part[0]);
  const auto high = Lerp(Byte<2>(bits), Byte<3>(bits), places.part[0]);
  return Lerp(low, high, places.part[1]);
}

/// A vector of words from as many places: costs less than gathering them.
template <std::size_t kCount>
HWY_INLINE hn::Vec<hn::FixedTag<std::uint64_t, kCount>> LoadWords(const std::uint64_t* words,
                                                                  const std::int32_t* places) {
  const hn::FixedTag<std::uint64_t, kCount> d;
  if constexpr (kCount == 1) {
    return hn::LoadU(d, words + places[0]);
  } else {
    return hn::Combine(d, LoadWords<kCount / 2>(words, places + kCount / 2),
                       LoadWords<kCount / 2>(words, places));
  }
}

/// The eight bytes of cells, those in front and those behind.
struct CellCorners {
  hn::Vec<Bits> front, back;

  CellCorners() = default;
  HWY_INLINE CellCorners(const std::uint64_t* cell_corners, const Places& places)
      : CellCorners(cell_corners, places.cells) {}
  HWY_INLINE CellCorners(const std::uint64_t* cell_corners, IntVector cells) {
    HWY_ALIGN std::int32_t stored[kPacketRays];
    hn::Store(cells, Ints(), stored);
    *this = CellCorners(cell_corners, stored);
  }
  HWY_INLINE CellCorners(const std::uint64_t* cell_corners, const std::int32_t* cells) {
    const Bits du;
    constexpr std::size_t kHalf = hn::MaxLanes(Lanes()) / 2;  // words are twice as wide as lanes
    const auto lower = LoadWords<kHalf>(cell_corners, cells);
    const auto upper = LoadWords<kHalf>(cell_corners, cells + kHalf);
    front = hn::ConcatEven(du, hn::BitCast(du, upper), hn::BitCast(du, lower));
    back = hn::ConcatOdd(du, hn::BitCast(du, upper), hn::BitCast(du, lower));
  }

  HWY_INLINE Vector Value(const Places& places) const {
    return Lerp(Face(front, places), Face(back, places), places.part[2]);
  }
  /// Control points of the cubic that the value is on the straight way from place `a` to place `b` of the
  /// cells: what is linear along each axis at corners of the box between the two, averaged over the axes.
  HWY_INLINE void ControlPoints(const Vector* a, const Vector* b, Vector* points) const {
    Vector fronts[4], backs[4];  // at (a, a), (b, a), (a, b), (b, b) along x and y
    FaceCorners(front, a, b, fronts);
    FaceCorners(back, a, b, backs);
    const auto third = hn::Set(Lanes(), 1.0f / 3);
    points[0] = Lerp(fronts[0], backs[0], a[2]);
    points[3] = Lerp(fronts[3], backs[3], b[2]);
    const auto aab = Lerp(fronts[0], backs[0], b[2]);
    const auto ones = hn::Add(Lerp(fronts[1], backs[1], a[2]), Lerp(fronts[2], backs[2], a[2]));
    points[1] = hn::Mul(third, hn::Add(aab, ones));
    const auto bba = Lerp(fronts[3], backs[3], a[2]);
    const auto twos = hn::Add(Lerp(fronts[1], backs[1], b[2]), Lerp(fronts[2], backs[2], b[2]));
    points[2] = hn::Mul(third, hn::Add(bba, twos));
  }

  /// Of the lowest and the highest bytes of these cells and others.
  template <typename... Others>
  HWY_INLINE Vector LowWith(const Others&... others) const {
    auto low = Lowest();
    ((low = hn::Min(low, others.Lowest())), ...);
    return Fold(low, [](auto x, auto y) { return hn::Min(x, y); });
  }
  template <typename... Others>
  HWY_INLINE Vector HighWith(const Others&... others) const {
    auto high = Highest();
    ((high = hn::Max(high, others.Highest())), ...);
    return Fold(high, [](auto x, auto y) { return hn::Max(x, y); });
  }

 private:
  /// Bilinear in the bytes of a face, at (a, a), (b, a), (a, b) and (b, b).
  static HWY_INLINE void FaceCorners(hn::Vec<Bits> bits, const Vector* a, const Vector* b, Vector* corners) {
    const auto low = Byte<0>(bits), high = Byte<2>(bits);
    const auto low_step = hn::Sub(Byte<1>(bits), low), high_step = hn::Sub(Byte<3>(bits), high);
    const auto low_a = hn::MulAdd(a[0], low_step, low), low_b = hn::MulAdd(b[0], low_step, low);
    const auto step_a = hn::Sub(hn::MulAdd(a[0], high_step, high), low_a);
    const auto step_b = hn::Sub(hn::MulAdd(b[0], high_step, high), low_b);
    corners[0] = hn::MulAdd(a[1], step_a, low_a);
    corners[1] = hn::MulAdd(a[1], step_b, low_b);
    corners[2] = hn::MulAdd(b[1], step_a, low_a);
    corners[3] = hn::MulAdd(b[1], step_b, low_b);
  }
  using ByteLanes = hn::Repartition<std::uint8_t, Lanes>;
  using ByteVector = hn::Vec<ByteLanes>;

  static HWY_INLINE ByteVector Bytes(hn::Vec<Bits> bits) { return hn::BitCast(ByteLanes(), bits); }
  HWY_INLINE ByteVector Lowest() const { return hn::Min(Bytes(front), Bytes(back)); }
  HWY_INLINE ByteVector Highest() const { return hn::Max(Bytes(front), Bytes(back)); }
  /// The choice among the four bytes of each lane.
  template <typename Choose>
  static HWY_INLINE Vector Fold(ByteVector bytes, const Choose& choose) {
    const Bits du;
    bytes = choose(bytes, Bytes(hn::ShiftRight<16>(hn::BitCast(du, bytes))));
    bytes = choose(bytes, Bytes(hn::ShiftRight<8>(hn::BitCast(du, bytes))));
    return Byte<0>(hn::BitCast(du, bytes));
  }
};

/// A grey value between voxels, and the lowest and the highest of the eight around.
struct Grey {
  Vector value, low, high;
};

HWY_INLINE Grey SampleCellCorners(const std::uint64_t* cell_corners, const Places& places) {
  const CellCorners cells(cell_corners, places);
  return {cells.Value(places), cells.LowWith(), cells.HighWith()};
}

HWY_INLINE Grey SampleGreys(const float* greys, const MarchGrid& grid, const Places& places) {
  const Lanes d;
  const std::ptrdiff_t row = grid.size[0];
  const std::ptrdiff_t slice = row * grid.size[1];
  const auto cell = hn::Load(Ints(), places.cells);
  Grey grey{hn::Zero(d), hn::GatherIndex(d, greys, cell), hn::Zero(d)};
  grey.high = grey.low;
  const auto edge = [&](std::ptrdiff_t offset) {
    const auto left = hn::GatherIndex(d, greys + offset, cell);
    const auto right = hn::GatherIndex(d, greys + offset + 1, cell);
    grey.low = hn::Min(grey.low, hn::Min(left, right));
    grey.high = hn::Max(grey.high, hn::Max(left, right));
    return Lerp(left, right, places.part[0]);
  };
  const auto front = Lerp(edge(0), edge(row), places.part[1]);
  const auto back = Lerp(edge(slice), edge(slice + row), places.part[1]);
  grey.value = Lerp(front, back, places.part[2]);
  return grey;
}

/// A range by the values of the four voxels around the face that cells begin with: they and their neighbours
/// `across`, in both directions. Every voxel has `kEach` values, of which the first counts.
template <std::ptrdiff_t kEach>
HWY_INLINE void WidenByFace(const float* values, IntVector cells, const IntVector* across, Vector& low,
                            Vector& high) {
  const Ints di;
  HWY_ALIGN std::int32_t voxels[kPacketRays];
  HWY_ALIGN std::int32_t right[kPacketRays];
  HWY_ALIGN std::int32_t below[kPacketRays];
  HWY_ALIGN float lows[kPacketRays];
  HWY_ALIGN float highs[kPacketRays];
  hn::Store(cells, di, voxels);
  hn::Store(across[0], di, right);
  hn::Store(across[1], di, below);
  for (std::size_t n = 0; n < hn::Lanes(di); ++n) {
    const float* const upper = values + kEach * voxels[n];
    const float* const lower = upper + kEach * below[n];
    const std::ptrdiff_t beside = kEach * right[n];
    lows[n] = std::min(std::min(*upper, upper[beside]), std::min(*lower, lower[beside]));
    highs[n] = std::max(std::max(*upper, upper[beside]), std::max(*lower, lower[beside]));
  }
  low = hn::Min(low, hn::Load(Lanes(), lows));
  high = hn::Max(high, hn::Load(Lanes(), highs));
}

/// Four values between voxels.
struct Four {
  Vector of[4];
};

/// What four values per voxel are at the places of a vector, ray by ray.
class FourSampler {
 public:
  HWY_INLINE FourSampler(const float* fours, const MarchGrid& grid, const Places& places)
      : fours_(fours), row_(std::ptrdiff_t{4} * grid.size[0]), slice_(row_ * grid.size[1]) {
    std::copy_n(places.cells, hn::Lanes(Lanes()), cells_);
    for (std::size_t a = 0; a < 3; ++a) hn::Store(places.part[a], Lanes(), parts_[a]);
  }

  HWY_INLINE Four Between() const {
    HWY_ALIGN float samples[4 * kPacketRays];
    for (std::size_t n = 0; n < hn::Lanes(Lanes()); ++n) {
      const float* corner = fours_ + std::ptrdiff_t{4} * cells_[n];
      const auto front = Mix(Edge(corner, n), Edge(corner + row_, n), parts_[1][n]);
      const auto back = Mix(Edge(corner + slice_, n), Edge(corner + slice_ + row_, n), parts_[1][n]);
      hn::Store(Mix(front, back, parts_[2][n]), OfOne(), samples + 4 * n);
    }
    Four four;
    hn::LoadInterleaved4(Lanes(), samples, four.of[0], four.of[1], four.of[2], four.of[3]);
    return four;
  }

  /// The lowest and the highest first value of the eight around.
  HWY_INLINE void Range(Vector& low, Vector& high) const {
    HWY_ALIGN float lows[kPacketRays];
    HWY_ALIGN float highs[kPacketRays];
    for (std::size_t n = 0; n < hn::Lanes(Lanes()); ++n) {
      const float* corner = fours_ + std::ptrdiff_t{4} * cells_[n];
      lows[n] = highs[n] = corner[0];
      for (const std::ptrdiff_t voxel :
           {std::ptrdiff_t{4}, row_, row_ + 4, slice_, slice_ + 4, slice_ + row_, slice_ + row_ + 4}) {
        lows[n] = std::min(lows[n], corner[voxel]);
        highs[n] = std::max(highs[n], corner[voxel]);
      }
    }
    low = hn::Load(Lanes(), lows);
    high = hn::Load(Lanes(), highs);
  }

 private:
  using OfOne = hn::FixedTag<float, 4>;
  using OneVector = hn::Vec<OfOne>;

  /// As a sum of what is not negative: what is next to nothing is right to its last places, too, so that
  /// colours may be divided by their weight.
  static HWY_INLINE OneVector Mix(OneVector a, OneVector b, float part) {
    return hn::MulAdd(hn::Set(OfOne(), part), b, hn::Mul(hn::Set(OfOne(), 1 - part), a));
  }
  HWY_INLINE OneVector Edge(const float* corner, std::size_t n) const {
    return Mix(hn::LoadU(OfOne(), corner), hn::LoadU(OfOne(), corner + 4), parts_[0][n]);
  }

  const float* fours_;
  std::ptrdiff_t row_, slice_;
  HWY_ALIGN std::int32_t cells_[kPacketRays];
  HWY_ALIGN float parts_[3][kPacketRays];
};

}  // namespace splatlas::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // SPLATLAS_PLAYER_MARCH_SAMPLES_INL_H_

// Kernels of the rasteriser. Highway compiles this file once for every instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "player/render/surfaces/raster_simd.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include <cstddef>
#include <cstdint>

#include <hwy/highway.h>

#include "player/render/surfaces/screen_triangle.h"

HWY_BEFORE_NAMESPACE();
namespace splatlas::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using I = hn::CappedTag<std::int32_t, kRasterPadding>;
using Ints = hn::Vec<I>;

std::size_t Select(const std::uint32_t* corners, std::size_t count, const SnappedVertices& vertices,
                   const PixelBox& box, std::int32_t reach, std::uint32_t* out) {
  const I d;
  const Ints byte = hn::Set(d, 0xff), up = hn::Set(d, (1 << kSubPixelBits) - 1), reaches = hn::Set(d, reach);
  std::size_t found = 0;
  for (std::size_t n = 0; n < count; n += hn::Lanes(d)) {
    const Ints packed = hn::BitCast(d, hn::LoadU(hn::RebindToUnsigned<I>(), corners + n));
    const Ints a = hn::And(packed, byte), b = hn::And(hn::ShiftRight<8>(packed), byte),
               c = hn::And(hn::ShiftRight<16>(packed), byte);
    const auto misses = [&](const std::int32_t* snapped, std::int32_t first, std::int32_t last) {
      const Ints of_a = hn::GatherIndex(d, snapped, a), of_b = hn::GatherIndex(d, snapped, b),
                 of_c = hn::GatherIndex(d, snapped, c);
      const Ints low = hn::Sub(hn::Min(hn::Min(of_a, of_b), of_c), reaches);
      const Ints high = hn::Add(hn::Max(hn::Max(of_a, of_b), of_c), reaches);
      const Ints from = hn::Max(hn::ShiftRight<kSubPixelBits>(hn::Add(low, up)), hn::Set(d, first));
      const Ints to = hn::Min(hn::ShiftRight<kSubPixelBits>(high), hn::Set(d, last));
      return hn::Lt(to, from);
    };
    const auto outside =
        hn::Or(misses(vertices.x, box.x_first, box.x_last), misses(vertices.y, box.y_first, box.y_last));
    const auto chosen = hn::AndNot(outside, hn::FirstN(d, count - n));
    const Ints number = hn::Iota(d, static_cast<std::int32_t>(n));
    found += hn::CompressStore(hn::BitCast(hn::RebindToUnsigned<I>(), number),
                               hn::RebindMask(hn::RebindToUnsigned<I>(), chosen), hn::RebindToUnsigned<I>(),
                               out + found);
  }
  return found;
}

void Cover(const SmallEdges& edges, std::int32_t columns, std::int32_t rows, std::uint32_t* out) {
  const hn::CappedTag<std::int32_t, 8> d;
  using V = hn::Vec<decltype(d)>;
  const auto lanes = static_cast<std::int32_t>(hn::Lanes(d));
  const V column = hn::Iota(d, 0);
  for (std::int32_t y = 0; y < rows; ++y) out[y] = 0;
  for (std::int32_t x = 0; x < columns; x += lanes) {
    const V at = hn::Add(column, hn::Set(d, x));
    const auto edge = [&](std::size_t n) {
      return hn::Add(hn::Set(d, edges.first[n]), hn::Mul(at, hn::Set(d, edges.per_x[n])));
    };
    V a = edge(0), b = edge(1), c = edge(2);
    const V down_a = hn::Set(d, edges.per_y[0]), down_b = hn::Set(d, edges.per_y[1]),
            down_c = hn::Set(d, edges.per_y[2]);
    const std::uint32_t in_box = columns - x >= lanes ? (1U << lanes) - 1 : (1U << (columns - x)) - 1;
    for (std::int32_t y = 0; y < rows; ++y) {
      std::array<std::uint8_t, 8> bits{};
      hn::StoreMaskBits(d, hn::Lt(hn::Or(hn::Or(a, b), c), hn::Zero(d)), bits.data());
      out[y] |= (~bits[0] & in_box) << x;
      a = hn::Add(a, down_a);
      b = hn::Add(b, down_b);
      c = hn::Add(c, down_c);
    }
  }
}

}  // namespace splatlas::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace splatlas {
namespace {

HWY_EXPORT(Select);
HWY_EXPORT(Cover);

}  // namespace

std::size_t select_triangles(const std::uint32_t* corners, std::size_t count, const SnappedVertices& vertices,
                             const PixelBox& box, std::int32_t reach, std::uint32_t* out) {
  return HWY_DYNAMIC_DISPATCH(Select)(corners, count, vertices, box, reach, out);
}

void cover_pixels(const SmallEdges& edges, std::int32_t columns, std::int32_t rows, std::uint32_t* out) {
  HWY_DYNAMIC_DISPATCH(Cover)(edges, columns, rows, out);
}

}  // namespace splatlas
#endif  // HWY_ONCE

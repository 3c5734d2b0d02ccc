#include <algorithm>
#include <cstddef>
#include <map>
#include <span>
#include <utility>

#include <itkBinaryBallStructuringElement.h>

#include "format/tasks/thread_pool.h"
#include "preprocess/classify/segment_volume.h"

namespace splatlas {
namespace {

using Word = std::uint64_t;
constexpr std::int64_t kWordBits = 64;

/// A mask of one bit per voxel. Rows begin at whole words. What lies beyond is 0.
struct BitMask {
  explicit BitMask(const Index3& all)
      : size(all),
        words(static_cast<std::size_t>((size[0] + kWordBits - 1) / kWordBits)),
        bits(words * static_cast<std::size_t>(size[1] * size[2])) {}

  Index3 size;
  std::size_t words;  ///< of a row
  std::vector<Word> bits;

  void clear_beyond() {
    const std::int64_t used = size[0] % kWordBits;
    if (used == 0) return;
    for (std::size_t last = words - 1; last < bits.size(); last += words) bits[last] &= (Word{1} << used) - 1;
  }
};

template <typename Bits>
auto row_of(Bits& mask, std::int64_t j, std::int64_t k) {
  return std::span(mask.bits).subspan(static_cast<std::size_t>(k * mask.size[1] + j) * mask.words,
                                      mask.words);
}

/// The rows (dj, dk) of an ellipsoid by the voxels that they have on either side of their middle.
using Ellipsoid = std::map<std::int64_t, std::vector<std::pair<std::int64_t, std::int64_t>>>;

Ellipsoid ellipsoid_of(const Index3& radii) {
  itk::BinaryBallStructuringElement<std::uint8_t, 3> ball;
  itk::Size<3> radius;
  for (unsigned a = 0; a < 3; ++a) radius[a] = static_cast<itk::SizeValueType>(radii[a]);
  ball.SetRadius(radius);
  ball.CreateStructuringElement();
  Ellipsoid ellipsoid;
  const std::uint8_t* next = &ball.GetBufferReference()[0];
  for (std::int64_t dk = -radii[2]; dk <= radii[2]; ++dk) {
    for (std::int64_t dj = -radii[1]; dj <= radii[1]; ++dj, next += 2 * radii[0] + 1) {
      const std::int64_t voxels = std::count(next, next + 2 * radii[0] + 1, 1);
      if (voxels > 0) ellipsoid[voxels / 2].emplace_back(dj, dk);
    }
  }
  return ellipsoid;
}

/// Sets the bits up to `width` beside set ones. `before` is for the bits before.
void widen(std::span<Word> row, std::int64_t width, std::vector<Word>& before) {
  for (std::int64_t done = 0; done < width;) {
    const std::int64_t step = std::min({2 * done + 1, width - done, kWordBits - 1});
    std::ranges::copy(row, before.begin());
    for (std::size_t n = 0; n < row.size(); ++n) {
      row[n] |= before[n] << step | before[n] >> step;
      if (n > 0) row[n] |= before[n - 1] >> (kWordBits - step);
      if (n + 1 < row.size()) row[n] |= before[n + 1] << (kWordBits - step);
    }
    done += step;
  }
}

BitMask dilated(const BitMask& mask, const Ellipsoid& ellipsoid) {
  BitMask result(mask.size);
  parallel_for(static_cast<std::size_t>(mask.size[2]), 0, [&](std::size_t slice) {
    const auto k = static_cast<std::int64_t>(slice);
    std::vector<Word> reached(mask.words), before(mask.words);
    for (std::int64_t j = 0; j < mask.size[1]; ++j) {
      const std::span<Word> row = row_of(result, j, k);
      for (const auto& [width, rows] : ellipsoid) {
        std::ranges::fill(reached, 0);
        for (const auto& [dj, dk] : rows) {
          if (j + dj < 0 || k + dk < 0 || j + dj >= mask.size[1] || k + dk >= mask.size[2]) continue;
          const auto other = row_of(mask, j + dj, k + dk);
          for (std::size_t n = 0; n < other.size(); ++n) reached[n] |= other[n];
        }
        widen(reached, width, before);
        for (std::size_t n = 0; n < row.size(); ++n) row[n] |= reached[n];
      }
    }
  });
  result.clear_beyond();
  return result;
}

/// Calls visit(voxel, word, bit) for the voxels of a mask of `size`, which lies within a margin in `bits`.
template <typename Visit>
void for_each_bit(BitMask& bits, const Index3& size, const Index3& margin, const Visit& visit) {
  std::size_t voxel = 0;
  for (std::int64_t k = 0; k < size[2]; ++k) {
    for (std::int64_t j = 0; j < size[1]; ++j) {
      const auto row = row_of(bits, j + margin[1], k + margin[2]);
      for (std::int64_t i = margin[0]; i < margin[0] + size[0]; ++i)
        visit(voxel++, row[static_cast<std::size_t>(i / kWordBits)], i % kWordBits);
    }
  }
}

/// Dilates and erodes, or the other way round. Beyond the margin counts as inside for the erosion.
void filter(std::vector<std::uint8_t>& mask, const Index3& size, const Index3& margin, const Index3& radii,
            bool dilates_first) {
  const Ellipsoid ellipsoid = ellipsoid_of(radii);
  BitMask bits({size[0] + 2 * margin[0], size[1] + 2 * margin[1], size[2] + 2 * margin[2]});
  for_each_bit(bits, size, margin,
               [&](std::size_t voxel, Word& word, std::int64_t bit) { word |= Word{mask[voxel]} << bit; });
  const auto invert = [&] {
    for (Word& word : bits.bits) word = ~word;
    bits.clear_beyond();
  };
  for (const bool dilates : {dilates_first, !dilates_first}) {
    if (!dilates) invert();
    bits = dilated(bits, ellipsoid);
    if (!dilates) invert();
  }
  for_each_bit(bits, size, margin, [&](std::size_t voxel, Word word, std::int64_t bit) {
    mask[voxel] = static_cast<std::uint8_t>(word >> bit & 1);
  });
}

}  // namespace

void close_mask(std::vector<std::uint8_t>& mask, const Index3& size, const Index3& radii) {
  filter(mask, size, radii, radii, true);
}

void open_mask(std::vector<std::uint8_t>& mask, const Index3& size, const Index3& radii) {
  filter(mask, size, {0, 0, 0}, radii, false);
}

}  // namespace splatlas

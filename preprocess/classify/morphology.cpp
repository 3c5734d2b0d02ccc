#include "preprocess/classify/morphology.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <span>
#include <utility>

#include <itkBinaryBallStructuringElement.h>

#include "format/tasks/thread_pool.h"

namespace splatlas {
namespace {

using Word = std::uint64_t;
constexpr std::int64_t kWordBits = 64;

/// A mask of one bit per voxel. Rows begin at whole words. What lies beyond is 0.
class BitMask {
 public:
  explicit BitMask(const Index3& size)
      : size_(size),
        words_(static_cast<std::size_t>((size[0] + kWordBits - 1) / kWordBits)),
        bits_(words_ * static_cast<std::size_t>(size[1] * size[2])) {}

  [[nodiscard]] const Index3& size() const { return size_; }
  [[nodiscard]] std::size_t words() const { return words_; }
  [[nodiscard]] bool has_row(std::int64_t j, std::int64_t k) const {
    return j >= 0 && k >= 0 && j < size_[1] && k < size_[2];
  }
  [[nodiscard]] std::span<Word> row(std::int64_t j, std::int64_t k) {
    return std::span(bits_).subspan(static_cast<std::size_t>(k * size_[1] + j) * words_, words_);
  }
  [[nodiscard]] std::span<const Word> row(std::int64_t j, std::int64_t k) const {
    return std::span(bits_).subspan(static_cast<std::size_t>(k * size_[1] + j) * words_, words_);
  }
  void invert() {
    for (Word& word : bits_) word = ~word;
    clear_beyond();
  }
  void clear_beyond() {
    const std::int64_t used = size_[0] % kWordBits;
    if (used == 0) return;
    for (std::size_t last = words_ - 1; last < bits_.size(); last += words_)
      bits_[last] &= (Word{1} << used) - 1;
  }

 private:
  Index3 size_;
  std::size_t words_;
  std::vector<Word> bits_;
};

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
  BitMask result(mask.size());
  parallel_for(static_cast<std::size_t>(mask.size()[2]), 0, [&](std::size_t slice) {
    const auto k = static_cast<std::int64_t>(slice);
    std::vector<Word> reached(mask.words()), before(mask.words());
    for (std::int64_t j = 0; j < mask.size()[1]; ++j) {
      const std::span<Word> row = result.row(j, k);
      for (const auto& [width, rows] : ellipsoid) {
        std::ranges::fill(reached, 0);
        for (const auto& [dj, dk] : rows) {
          if (!mask.has_row(j + dj, k + dk)) continue;
          const std::span<const Word> other = mask.row(j + dj, k + dk);
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
template <typename Bits, typename Visit>
void for_each_bit(Bits& bits, const Index3& size, const Index3& margin, const Visit& visit) {
  std::size_t voxel = 0;
  for (std::int64_t k = 0; k < size[2]; ++k) {
    for (std::int64_t j = 0; j < size[1]; ++j) {
      const auto row = bits.row(j + margin[1], k + margin[2]);
      for (std::int64_t i = margin[0]; i < margin[0] + size[0]; ++i)
        visit(voxel++, row[static_cast<std::size_t>(i / kWordBits)], i % kWordBits);
    }
  }
}

BitMask bits_of(const std::vector<std::uint8_t>& mask, const Index3& size, const Index3& margin) {
  Index3 all;
  for (std::size_t a = 0; a < 3; ++a) all[a] = size[a] + 2 * margin[a];
  BitMask bits(all);
  for_each_bit(bits, size, margin,
               [&](std::size_t voxel, Word& word, std::int64_t bit) { word |= Word{mask[voxel]} << bit; });
  return bits;
}

void set_voxels(const BitMask& bits, const Index3& size, const Index3& margin,
                std::vector<std::uint8_t>& mask) {
  for_each_bit(bits, size, margin, [&](std::size_t voxel, Word word, std::int64_t bit) {
    mask[voxel] = static_cast<std::uint8_t>(word >> bit & 1);
  });
}

/// Beyond the bits counts as inside.
BitMask eroded(BitMask bits, const Ellipsoid& ellipsoid) {
  bits.invert();
  bits = dilated(bits, ellipsoid);
  bits.invert();
  return bits;
}

}  // namespace

void close_mask(std::vector<std::uint8_t>& mask, const Index3& size, const Index3& radii) {
  const Ellipsoid ellipsoid = ellipsoid_of(radii);
  set_voxels(eroded(dilated(bits_of(mask, size, radii), ellipsoid), ellipsoid), size, radii, mask);
}

void open_mask(std::vector<std::uint8_t>& mask, const Index3& size, const Index3& radii) {
  constexpr Index3 kNoMargin{0, 0, 0};
  const Ellipsoid ellipsoid = ellipsoid_of(radii);
  set_voxels(dilated(eroded(bits_of(mask, size, kNoMargin), ellipsoid), ellipsoid), size, kNoMargin, mask);
}

}  // namespace splatlas

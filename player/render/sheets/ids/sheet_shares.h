// Shares of structures in the opacity of sheet pixels.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "player/picture.h"
#include "player/render/contributions/fragment_shares.h"
#include "player/render/sheets/band_image.h"
#include "player/render/sheets/fragment_order.h"
#include "player/render/sheets/ids/slice_numbers.h"
#include "player/render/sheets/sheet_fragments.h"
#include "player/render/sheets/splat/splat_kernels.h"
#include "player/render/view/shear.h"
#include "player/render/view/sheet_window.h"

namespace splatlas {

/// Blocks of pixels of a phase row. Pixels of voxel blocks begin anywhere in a block of pixels.
struct PixelBlocks {
  static constexpr std::int64_t kBefore = 2 * kBlock;  ///< pixels in front of pixel 0

  /// Number of blocks for this many columns, margins included.
  [[nodiscard]] static std::int64_t count(std::int64_t columns) {
    return (columns + 2 * kBefore + kBlock) >> kBlockBits;
  }
  [[nodiscard]] static std::int64_t block(std::int64_t pixel) { return (pixel + kBefore) >> kBlockBits; }
  [[nodiscard]] static std::size_t lane(std::int64_t pixel) {
    return static_cast<std::size_t>(pixel & (kBlock - 1));
  }
};

/// Shares of structures in a finished sheet. The share of a structure in a pixel is its part of the pixel's
/// opacity.
struct SheetShares {
  /// Shares of a structure in a block of pixels, in 1/65535.
  using Shares = std::array<std::uint16_t, kBlock>;
  /// Rows of one band, by fine row, phase and block of pixels.
  struct Band {
    std::vector<std::uint32_t> first;  ///< offsets of the blocks, and the end
    std::vector<StructureNumber> numbers;
    std::vector<Shares> shares;
  };

  SheetWindow window;
  std::int64_t band_rows = 1;            ///< voxel rows of a band
  std::vector<Band> bands;               ///< empty: no volume
  std::vector<StructureNumber> winners;  ///< of each pixel, row by row, the largest share; 0: transparent

  /// Empties it for a new sheet, and keeps its memory.
  void reset(const SheetWindow& of_sheet, std::int64_t rows_of_band);
  /// Frees everything.
  void clear() { *this = {}; }
  [[nodiscard]] bool contains(std::int64_t x, std::int64_t y) const {
    return x >= 0 && y >= 0 && x < window.fine_columns() && y < window.fine_rows();
  }
  [[nodiscard]] StructureNumber winner(std::int64_t x, std::int64_t y) const {
    return contains(x, y) ? winners[static_cast<std::size_t>(y * window.fine_columns() + x)] : 0;
  }
  /// Calls visit(number, share) for the structures of pixel (x, y); nothing outside the sheet.
  template <typename Visit>
  void for_each(std::int64_t x, std::int64_t y, const Visit& visit) const {
    if (bands.empty() || !contains(x, y)) return;
    const std::int64_t band_height = band_rows * window.scale;
    const Band& band = bands[static_cast<std::size_t>(y / band_height)];
    const std::int64_t phase = x % window.scale, column = x / window.scale;
    const auto block = static_cast<std::size_t>(((y % band_height) * window.scale + phase) *
                                                    PixelBlocks::count(window.columns) +
                                                PixelBlocks::block(column));
    for (std::uint32_t n = band.first[block]; n < band.first[block + 1]; ++n) {
      const std::uint16_t share = band.shares[n][PixelBlocks::lane(column)];
      if (share > 0) visit(band.numbers[n], static_cast<float>(share) * (1.0f / 65535));
    }
  }
};

/// Shares of structures in the pixels of a sheet and in front of its fragments.
struct SharePass {
  VoxelNumbers numbers;
  SheetShares& shares;
  FragmentShares& of_fragments;
  std::vector<std::vector<FragmentShare>> of_bands{};  ///< in front of the fragments of each band

  void begin(const SheetWindow& window, std::int64_t band_rows) {
    shares.reset(window, band_rows);
    of_bands.resize(shares.bands.size());
  }
  void finish(const FragmentOrder& fragments) const { of_fragments.build(fragments.entries(), of_bands); }
};

/// Trace policy of Band: accumulates the shares in a band of the sheet, slab by slab. The opacity that a slab
/// adds to a pixel belongs to the structures around in proportion to their extinctions there. Keeps its
/// memory. Not thread-safe.
class BandShares {
 public:
  /// State of all bands.
  using Frame = SharePass;

  /// Empties it for a band. All references must outlive it.
  void begin(SharePass& pass, const Shear& shear, const SheetWindow& window, const BandImage& image,
             std::size_t band);

  /// Begins a slab of these slices. A slab of one slice has no `behind`.
  void begin_slab(const SlicePair& slices) { numbers_.select(slices); }

  /// Adds a slab that has been composited onto `rows.pairs` pairs of rows in all phases. `fine_row` is the
  /// first fine row of the first pair. Cost: linear in the blocks, times the structures in each.
  void add(const SheetRows& rows, std::span<const Phase> phases, std::int64_t fine_row);

  /// Adds the shares of a pixel so far to those in front of a fragment.
  void add_fragment(const FragmentPixel& pixel, const AccumulatedRow& row);

  /// Writes the rows of the band.
  void store() const;

 private:
  static constexpr std::uint32_t kNone = 0xffffffffu;
  static constexpr std::size_t kLanes = kBlock;
  /// Shares of a structure in the pixels from a block of pixels on.
  struct Sums {
    alignas(64) std::array<float, 2 * kLanes> of{};
    std::uint32_t next = kNone;
    StructureNumber number = 0;
  };
  /// Voxels around the pixels of a block: up to two rows of up to two slices.
  struct Surroundings;

  [[nodiscard]] std::size_t block_of(std::int64_t fine_row, std::int64_t phase, std::int64_t column) const {
    return static_cast<std::size_t>(((fine_row - first_) * scale_ + phase) * blocks_ +
                                    PixelBlocks::block(column));
  }
  float* sums_of(std::size_t block, StructureNumber number);
  /// A block of a pair of voxel rows.
  struct VoxelBlock {
    const NumberedSlices& slices;
    std::int64_t upper = 0, block = 0;
  };
  void add_block(const SheetRows& rows, std::span<const Phase> phases, std::int64_t fine_row,
                 const VoxelBlock& voxel_block);
  /// Opacity added to kBlock pixels since the last call; false if there is none.
  bool take_rise(std::int64_t fine_row, std::int64_t phase, std::int64_t pixel, float* rise);

  SharePass* pass_ = nullptr;
  std::size_t band_ = 0;
  BandNumbers numbers_;  // of the current slab
  const BandImage* image_ = nullptr;
  std::int64_t scale_ = 1, columns_ = 0, blocks_ = 0, first_ = 0, last_ = 0, stride_ = 0;
  std::vector<float> seen_;           // opacity so far, by phase row
  std::vector<std::uint32_t> heads_;  // lists of sums, by phase row and block of pixels
  std::vector<Sums> sums_;
};

}  // namespace splatlas

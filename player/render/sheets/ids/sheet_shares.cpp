#include "player/render/sheets/ids/sheet_shares.h"

#include <algorithm>
#include <bit>
#include <optional>

#include "player/render/sheets/splat/block_runs.h"

namespace splatlas {
namespace {

/// Extinctions of a block of a row; null if the row has no such block.
const float* extinctions_of(const SliceSpans& slice, std::int64_t row, std::int64_t block) {
  const std::span<const Span> spans = slice.row(row);
  const auto after = std::ranges::upper_bound(
      spans, block, {}, [](const Span& span) { return std::int64_t{span.first_block}; });
  if (after == spans.begin()) return nullptr;
  const Span& span = *(after - 1);
  if (block >= std::int64_t{span.first_block} + span.blocks) return nullptr;
  return slice.optics.data() + (std::int64_t{span.offset} + block - span.first_block) * slice.block_floats();
}

}  // namespace

void SheetShares::reset(const SheetWindow& of_sheet, std::int64_t rows_of_band) {
  if (of_sheet.empty()) return clear();
  window = of_sheet;
  band_rows = rows_of_band;
  bands.resize(static_cast<std::size_t>((window.rows + band_rows - 1) / band_rows));
  winners.resize(static_cast<std::size_t>(window.fine_rows() * window.fine_columns()));
}

/// The structures of the voxels and, for each of them, its extinctions.
struct BandShares::Surroundings {
  static constexpr std::size_t kMaxRows = 4, kVoxels = kLanes + 1;
  static constexpr std::size_t kMaxStructures = kMaxRows * kVoxels;
  struct Row {
    float slice_weight = 1;
    bool is_lower = false;
    const StructureNumber* numbers = nullptr;  // kVoxels, from the last voxel of the previous block on
    std::array<float, kVoxels> extinctions;
  };

  std::size_t row_count = 0, structure_count = 0;
  std::array<Row, kMaxRows> rows;
  std::array<StructureNumber, kMaxStructures> structures;

  /// Finds the structures. Fetches extinctions only if there are several.
  Surroundings(const NumberedSlices& slices, std::int64_t upper, std::int64_t block) {
    StructureNumber one = 0;
    const auto merge = [&one](StructureNumber number) {
      if (number != 0 && number != one) one = one == 0 ? number : SliceNumbers::kSeveral;
    };
    const SliceSpans* spans[kMaxRows];
    std::int64_t numbers_of_rows[kMaxRows];
    for (std::size_t s = 0; s < 2; ++s) {
      if (slices.spans[s] == nullptr) continue;
      for (const std::int64_t row : {upper, upper + 1}) {
        if (!slices.numbers[s]->has(row)) continue;
        Row& entry = rows[row_count];
        entry.slice_weight = slices.weights[s];
        entry.is_lower = row != upper;
        entry.numbers = slices.numbers[s]->voxels(row, block);
        merge(slices.numbers[s]->block(row, block));
        merge(entry.numbers[0]);
        spans[row_count] = slices.spans[s];
        numbers_of_rows[row_count++] = row;
      }
    }
    if (one == 0) return;
    if (one != SliceNumbers::kSeveral) {
      structures[structure_count++] = one;
      return;
    }
    for (std::size_t n = 0; n < row_count; ++n) {
      fetch(*spans[n], numbers_of_rows[n], block, rows[n]);
      list(rows[n]);
    }
  }

 private:
  static void fetch(const SliceSpans& slice, std::int64_t number, std::int64_t block, Row& row) {
    row.extinctions.fill(0);
    if (const float* before = extinctions_of(slice, number, block - 1))
      row.extinctions[0] = before[kBlock - 1];
    if (const float* here = extinctions_of(slice, number, block))
      std::copy_n(here, kBlock, &row.extinctions[1]);
  }
  void list(const Row& row) {
    StructureNumber last = 0;
    for (std::size_t n = 0; n < kVoxels; ++n) {
      const StructureNumber number = row.numbers[n];
      if (number == last || number == 0 || row.extinctions[n] <= 0) continue;
      last = number;
      const auto end = structures.begin() + static_cast<std::ptrdiff_t>(structure_count);
      if (std::find(structures.begin(), end, number) == end) structures[structure_count++] = number;
    }
  }
};

void BandShares::begin(SharePass& pass, const Shear& shear, const SheetWindow& window, const BandImage& image,
                       std::size_t band) {
  pass_ = &pass;
  band_ = band;
  numbers_.begin(pass.numbers, shear, window, image);
  image_ = &image;
  scale_ = window.scale;
  columns_ = window.columns;
  blocks_ = PixelBlocks::count(columns_);
  first_ = image.first_fine_row();
  last_ = image.last_fine_row();
  stride_ = image.plane_stride();
  const auto phase_rows = static_cast<std::size_t>((last_ - first_) * scale_);
  seen_.assign(phase_rows * static_cast<std::size_t>(stride_), 0.0f);
  heads_.assign(phase_rows * static_cast<std::size_t>(blocks_), kNone);
  sums_.clear();
}

float* BandShares::sums_of(std::size_t block, StructureNumber number) {
  std::uint32_t& head = heads_[block];
  if (head != kNone && sums_[head].number == number) return sums_[head].of.data();
  for (std::uint32_t before = head; before != kNone; before = sums_[before].next) {
    const std::uint32_t found = sums_[before].next;
    if (found == kNone || sums_[found].number != number) continue;
    // Move it to the front: the next slab probably belongs to it, too
    sums_[before].next = sums_[found].next;
    sums_[found].next = head;
    head = found;
    return sums_[found].of.data();
  }
  const auto added = static_cast<std::uint32_t>(sums_.size());
  Sums& sums = sums_.emplace_back();
  sums.next = head;
  sums.number = number;
  head = added;
  return sums.of.data();
}

bool BandShares::take_rise(std::int64_t fine_row, std::int64_t phase, std::int64_t pixel, float* rise) {
  const float* const opacity =
      image_->row(fine_row, phase) + (image_->planes() - 1) * image_->plane_stride() + pixel;
  float* const seen = &seen_[static_cast<std::size_t>(((fine_row - first_) * scale_ + phase) * stride_ +
                                                      ImageRows::kMargin + pixel)];
  std::uint32_t any = 0;  // bits, since a sum of floats is not vectorised
  for (std::size_t n = 0; n < kLanes; ++n) {
    rise[n] = opacity[n] - seen[n];
    seen[n] = opacity[n];
    any |= std::bit_cast<std::uint32_t>(rise[n]);
  }
  return any != 0;
}

void BandShares::add(const SheetRows& rows, std::span<const Phase> phases, std::int64_t fine_row) {
  Blocks reach{0, 0};
  for (std::size_t n = 0; n < phases.size(); ++n) {
    SheetRows of_phase = rows;
    of_phase.phases[0] = phases[n];
    of_phase.phase_count = 1;
    const Blocks of_one = blocks_in_reach(of_phase, ImageRows{.columns = columns_});
    reach = n == 0 ? of_one : Blocks{std::min(reach.first, of_one.first), std::max(reach.last, of_one.last)};
  }
  for (std::int64_t pair = 0; pair < rows.pairs; ++pair) {
    BlockRuns runs(rows, pair, reach);
    for (BlockRun run; runs.next(run);) {
      for (std::int64_t block = run.first; block < run.last; ++block)
        add_block(rows, phases, fine_row + pair * scale_, {numbers_.selected(), rows.upper + pair, block});
    }
  }
}

void BandShares::add_block(const SheetRows& rows, std::span<const Phase> phases, std::int64_t fine_row,
                           const VoxelBlock& voxel_block) {
  constexpr std::size_t kVoxels = Surroundings::kVoxels;
  std::optional<Surroundings> found;  // once a pixel is not hidden
  for (std::size_t between = 0; between < rows.rows_between; ++between) {
    const std::int64_t row = fine_row + static_cast<std::int64_t>(between);
    // Weigh the extinctions of each structure with those of the rows
    std::array<std::array<float, kVoxels>, Surroundings::kMaxStructures> weighted;
    bool is_weighted = false;
    const auto weigh = [&](const Surroundings& around) {
      is_weighted = true;
      for (std::size_t s = 0; s < around.structure_count; ++s) {
        weighted[s].fill(0);
        for (std::size_t r = 0; r < around.row_count; ++r) {
          const Surroundings::Row& voxels = around.rows[r];
          const float lower = rows.lower_weights[between];
          const float weight = voxels.slice_weight * (voxels.is_lower ? lower : 1 - lower);
          for (std::size_t n = 0; n < kVoxels; ++n)
            weighted[s][n] +=
                voxels.numbers[n] == around.structures[s] ? weight * voxels.extinctions[n] : 0.0f;
        }
      }
    };

    for (std::size_t phase = 0; phase < phases.size(); ++phase) {
      const std::int64_t pixel = voxel_block.block * kBlock + phases[phase].shift;
      if (pixel < -ImageRows::kMargin || pixel >= columns_) continue;
      alignas(64) std::array<float, kLanes> rise;
      const auto number_of_phase = static_cast<std::int64_t>(phase);
      if (!take_rise(row, number_of_phase, pixel, rise.data())) continue;
      if (!found) found.emplace(voxel_block.slices, voxel_block.upper, voxel_block.block);
      const Surroundings& around = *found;
      if (around.structure_count == 0) return;
      const std::size_t block = block_of(row, number_of_phase, pixel), lane = PixelBlocks::lane(pixel);
      if (around.structure_count == 1) {
        float* const sums = sums_of(block, around.structures[0]) + lane;
        for (std::size_t n = 0; n < kLanes; ++n) sums[n] += rise[n];
        continue;
      }
      // Divide the opacity in proportion to the interpolated extinctions
      if (!is_weighted) weigh(around);
      const float before = phases[phase].before;
      alignas(64) std::array<float, kLanes> total{};
      const auto extinction = [&](std::size_t s, std::size_t n) {
        return weighted[s][n + 1] + before * (weighted[s][n] - weighted[s][n + 1]);
      };
      for (std::size_t s = 0; s < around.structure_count; ++s) {
        for (std::size_t n = 0; n < kLanes; ++n) total[n] += extinction(s, n);
      }
      for (std::size_t n = 0; n < kLanes; ++n) total[n] = total[n] > 0 ? rise[n] / total[n] : 0.0f;
      for (std::size_t s = 0; s < around.structure_count; ++s) {
        float* const sums = sums_of(block, around.structures[s]) + lane;
        for (std::size_t n = 0; n < kLanes; ++n) sums[n] += total[n] * extinction(s, n);
      }
    }
  }
}

void BandShares::add_fragment(const FragmentPixel& pixel, const AccumulatedRow& row) {
  if (pixel.weight == 0) return;
  const std::size_t block = block_of(row.fine_row, pixel.phase, pixel.column);
  const std::size_t lane = PixelBlocks::lane(pixel.column);
  for (std::size_t back = 0; back < 2; ++back) {  // sums begin in this block or the one before
    for (std::uint32_t n = heads_[block - back]; n != kNone; n = sums_[n].next) {
      const float share = sums_[n].of[lane + back * kLanes];
      if (share <= 0) continue;
      pass_->of_bands[band_].push_back({static_cast<std::uint32_t>(pixel.entry), sums_[n].number,
                                        pixel.before, pixel.behind, pixel.weight * share});
    }
  }
}

void BandShares::store() const {
  SheetShares& shares = pass_->shares;
  SheetShares::Band& out = shares.bands[band_];
  out.first.clear();
  out.numbers.clear();
  out.shares.clear();
  for (std::int64_t row = first_; row < last_; ++row) {
    for (std::int64_t phase = 0; phase < scale_; ++phase) {
      for (std::int64_t block = 0; block < blocks_; ++block) {
        // Merge the sums that begin in this block and in the one before
        const std::size_t first_of_block = out.numbers.size();
        out.first.push_back(static_cast<std::uint32_t>(first_of_block));
        const std::int64_t pixel = block * kBlock - PixelBlocks::kBefore;
        if (pixel >= columns_ || pixel + kBlock <= 0) continue;
        const std::size_t at = block_of(row, phase, pixel);
        const auto take = [&](std::uint32_t head, std::size_t lane) {
          for (std::uint32_t n = head; n != kNone; n = sums_[n].next) {
            const auto of_block = out.numbers.begin() + static_cast<std::ptrdiff_t>(first_of_block);
            const auto found = std::find(of_block, out.numbers.end(), sums_[n].number);
            const auto place = static_cast<std::size_t>(found - out.numbers.begin());
            if (found == out.numbers.end()) {
              out.numbers.push_back(sums_[n].number);
              out.shares.emplace_back();
            }
            for (std::size_t i = 0; i < kLanes; ++i)
              out.shares[place][i] +=
                  static_cast<std::uint16_t>(65535 * std::min(sums_[n].of[lane + i], 1.0f));
          }
        };
        take(heads_[at], 0);
        take(heads_[at - 1], kLanes);

        // Find the largest share of each pixel
        for (std::int64_t column = std::max<std::int64_t>(pixel, 0);
             column < std::min(pixel + kBlock, columns_); ++column) {
          StructureNumber winner = 0;
          std::uint16_t largest = 0;
          for (std::size_t n = first_of_block; n < out.numbers.size(); ++n) {
            const std::uint16_t share = out.shares[n][PixelBlocks::lane(column)];
            if (share < largest || share == 0) continue;
            if (share == largest && out.numbers[n] > winner) continue;
            largest = share;
            winner = out.numbers[n];
          }
          shares.winners[static_cast<std::size_t>(row * scale_ * columns_ + column * scale_ + phase)] =
              winner;
        }
      }
    }
  }
  out.first.push_back(static_cast<std::uint32_t>(out.numbers.size()));
}

}  // namespace splatlas

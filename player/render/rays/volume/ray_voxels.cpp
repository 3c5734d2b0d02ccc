// Means of the voxels of a ray volume, for drafts; lighting and numbers of voxels and cells; bricks.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "format/result_macros.h"
#include "format/tasks/task_control.h"
#include "player/render/light/voxel_light.h"
#include "player/render/rays/volume/ray_volume.h"

namespace splatlas {

/// Finds the blocks of lit voxels by ascending number. O(1) amortised.
class LitCursor {
 public:
  explicit LitCursor(const LitBlocks& of) : next_(of.begin()), end_(of.end()) {}

  /// Null unless the voxel is lit.
  [[nodiscard]] const LitBlock* find(std::uint32_t number) {
    const std::uint32_t block = number >> kBlockBits;
    while (next_ != end_ && next_->block < block) ++next_;
    for (auto of = next_; of != end_ && of->block == block; ++of) {
      if (of->lights[number % kBlock].lit > 0) return &*of;
    }
    return nullptr;
  }

 private:
  LitBlocks::const_iterator next_, end_;
};

/// Adds up the voxels of slices of blocks.
class RayVolume::Averager {
 public:
  Averager(const RayVolume& fine, const SelectedRuns& runs, int level, RayVolume& coarse)
      : fine_(fine),
        runs_(runs),
        level_(level),
        coarse_(coarse),
        sums_(static_cast<std::size_t>(coarse.grid_.size[0])) {}

  /// Writes slice `z` of the box of blocks. `seen`: bricks with visible blocks. Returns the number of blocks.
  std::uint64_t average(std::int64_t z, const BrickMask& mask, std::vector<std::uint8_t>& seen) {
    const std::int64_t first = (z + coarse_.first_[2]) << level_;
    const std::int64_t slices = std::int64_t{1} << level_;
    std::uint64_t blocks = 0;
    std::vector<std::optional<LitCursor>> lit(static_cast<std::size_t>(slices));  // by slice of voxels
    for (std::int64_t n = 0; n < slices; ++n) {
      if (has_slice(first + n)) lit[static_cast<std::size_t>(n)].emplace(lit_of(first + n));
    }
    for (std::int64_t y = kMargin; y < coarse_.grid_.size[1] - kMargin; ++y) {
      const std::int64_t row = (y + coarse_.first_[1]) << level_;
      for (std::int64_t n = 0; n < slices; ++n) {
        std::optional<LitCursor>& of_slice = lit[static_cast<std::size_t>(n)];
        if (!of_slice) continue;
        runs_.for_each(first + n, row, row + slices,
                       [&](const ClassRun& run, std::uint32_t) { add(first + n, run, *of_slice); });
      }
      blocks += write(y, z, mask, seen);
    }
    return blocks;
  }

 private:
  [[nodiscard]] bool has_slice(std::int64_t slice) const {
    return slice >= fine_.first_[2] && slice < fine_.first_[2] + fine_.grid_.size[2];
  }
  [[nodiscard]] const LitBlocks& lit_of(std::int64_t slice) const {
    return fine_.sources_.front().lit[static_cast<std::size_t>(slice - fine_.first_[2])];
  }

  /// Adds the voxels of a run to the sums of their blocks. `lit`: of the slice.
  void add(std::int64_t slice, const ClassRun& run, LitCursor& lit) {
    const std::int64_t x = run.start - fine_.first_[0], y = run.row - fine_.first_[1];
    const std::size_t floats = fine_.voxel_floats_;
    const float* optics = fine_.extinctions() + floats * fine_.place(x, y, slice - fine_.first_[2]);
    std::uint32_t number = fine_.number(x, y);
    for (std::uint32_t voxel = run.start; voxel < run.start + run.length;
         ++voxel, ++number, optics += floats) {
      if (optics[0] <= 0) continue;
      std::array<float, 3> emission{};
      if (floats == kFour) std::copy_n(optics + 1, 3, emission.begin());
      VoxelLight light;
      if (const LitBlock* const block = lit.find(number)) {
        for (std::size_t c = 0; c < 3; ++c) emission[c] = block->whites[number % kBlock] * block->color[c];
        light = block->lights[number % kBlock];
      }
      sums_[static_cast<std::size_t>((voxel >> level_) - coarse_.first_[0])].add(optics[0], emission, light,
                                                                                 unpacked_);
    }
  }

  /// Writes the means of a row, and clears its sums. Returns their number.
  std::uint64_t write(std::int64_t y, std::int64_t z, const BrickMask& mask,
                      std::vector<std::uint8_t>& seen) {
    const float per_voxel = std::ldexp(1.0f, -3 * level_);
    Source& source = coarse_.sources_.front();
    auto* optics = reinterpret_cast<float*>(source.values.data());
    std::uint64_t blocks = 0;
    for (std::int64_t x = kMargin; x < coarse_.grid_.size[0] - kMargin; ++x) {
      VoxelSums& sums = sums_[static_cast<std::size_t>(x)];
      if (sums.extinction <= 0) continue;
      const std::size_t at = coarse_.voxel_floats_ * coarse_.place(x, y, z);
      optics[at] = sums.extinction * per_voxel;
      for (std::size_t c = 0; c + 1 < coarse_.voxel_floats_; ++c)
        optics[at + 1 + c] = sums.emission[c] * per_voxel;
      if (const std::uint16_t lit = sums.lit_share(); lit > 0) {
        const std::uint32_t number = coarse_.number(x, y);
        LitBlock& block =
            require_block(source.lit[static_cast<std::size_t>(z)], number >> kBlockBits, sums.color());
        block.whites[number % kBlock] = sums.weight * per_voxel;
        block.lights[number % kBlock] = {pack_normal(sums.normal), lit};
      }
      mark_around(mask, seen, x, y);
      sums = {};
      ++blocks;
    }
    return blocks;
  }

  const RayVolume& fine_;
  const SelectedRuns& runs_;
  const int level_;
  RayVolume& coarse_;
  const UnpackedNormals& unpacked_ = unpacked_normals();
  std::vector<VoxelSums> sums_;  // of a row of blocks
};

Result<RayVolume> RayVolume::means(const SelectedRuns& runs, int level, ThreadPool& pool) const {
  RayVolume coarse;
  coarse.runs_ = runs_;
  coarse.shade_ = shade_;
  coarse.voxel_floats_ = voxel_floats_;
  if (empty()) return coarse;

  // Frame the blocks
  for (std::size_t a = 0; a < 3; ++a) {
    const std::int64_t first = (first_[a] + kMargin) >> level;
    const std::int64_t last = (first_[a] + grid_.size[a] - 1 - kMargin) >> level;
    coarse.first_[a] = first - kMargin;
    coarse.grid_.size[a] = static_cast<std::int32_t>(last - first + 1 + 2 * kMargin);
  }
  const auto slices = static_cast<std::size_t>(coarse.grid_.size[2]);
  Source& source = coarse.sources_.emplace_back();
  SPLATLAS_ASSIGN_OR_RETURN(source.values, SparseBytes::reserve(coarse.place(0, 0, coarse.grid_.size[2]) *
                                                                voxel_floats_ * sizeof(float)));
  source.lit.resize(slices);

  // Average slices in parallel
  BrickMask mask(coarse.grid_);
  std::vector<std::vector<std::uint8_t>> seen(slices, std::vector<std::uint8_t>(mask.of_slice()));
  std::vector<std::uint64_t> blocks(slices);
  pool.for_each(slices, [&](std::size_t z) {
    blocks[z] = Averager(*this, runs, level, coarse).average(static_cast<std::int64_t>(z), mask, seen[z]);
  });
  mark_slices(mask, seen);
  source.active = coarse.active_ = brick_sums(mask);
  MarchSource& view = coarse.views_.emplace_back();
  (voxel_floats_ == 1 ? view.greys : view.optics) = coarse.extinctions();
  view.active = source.active.data();
  coarse.voxels_ = std::accumulate(blocks.begin(), blocks.end(), std::uint64_t{0});
  for (const LitBlocks& slice : source.lit) coarse.lit_blocks_ += slice.size();
  return coarse;
}

void RayVolume::light(const ParallelView& view, const Lighting& lighting, ThreadPool& pool) {
  if (lit_blocks_ == 0 || (lit_for_ && have_same_lighting(*lit_for_, view))) return;
  lit_for_.reset();
  const std::vector<float> factors = lighting.table();
  for (Source& source : sources_) {
    SparseBytes& bytes = source.transfer ? source.colors : source.values;
    // Colours of post-classified voxels come before their weight, those of others behind their extinction
    float* const colors = reinterpret_cast<float*>(bytes.data()) + (source.transfer ? 0 : 1);
    pool.for_each(source.lit.size(), [&](std::size_t slice) {
      float* const of_slice = colors + 4 * place(0, 0, static_cast<std::int64_t>(slice));
      for (const LitBlock& block : source.lit[slice]) {
        float* color = of_slice + std::size_t{4} * kBlock * block.block;
        for (std::size_t n = 0; n < kBlock; ++n, color += 4) {
          if (block.lights[n].lit == 0) continue;
          const float share = static_cast<float>(block.lights[n].lit) / VoxelLight::kAllLit;
          const float white = block.whites[n] * (1 + share * (factors[block.lights[n].normal] - 1));
          for (std::size_t c = 0; c < 3; ++c) color[c] = white * block.color[c];
        }
      }
    });
  }
  lit_for_ = view;
}

Result<void> RayVolume::number(const SelectedRuns& runs, std::span<const StructureNumber> of_draw,
                               ThreadPool& pool) {
  if (empty() || numbers() != nullptr) return {};
  const auto& size = grid_.size;
  const std::size_t row = static_cast<std::size_t>(size[0]), slice = row * static_cast<std::size_t>(size[1]);
  const auto slices = static_cast<std::size_t>(size[2]);
  SPLATLAS_ASSIGN_OR_RETURN(SparseBytes voxels,
                            SparseBytes::reserve(slice * slices * sizeof(StructureNumber)));
  SPLATLAS_ASSIGN_OR_RETURN(cell_numbers_, SparseBytes::reserve(slice * slices * sizeof(StructureNumber)));
  auto* const numbers = reinterpret_cast<StructureNumber*>(voxels.data());
  auto* const cells = reinterpret_cast<StructureNumber*>(cell_numbers_.data());
  const auto place = [&](const ClassRun& run, std::size_t z) {
    return z * slice + static_cast<std::size_t>(run.row - first_[1]) * row +
           static_cast<std::size_t>(run.start - first_[0]);
  };
  const auto merge = [&](std::size_t first, std::size_t count, StructureNumber number) {
    for (std::size_t n = first; n < first + count; ++n)
      cells[n] = cells[n] == 0 || cells[n] == number ? number : kSeveralNumbers;
  };
  // Number the voxels of a slice, and the cells between it and the next one
  pool.for_each(slices - 1, [&](std::size_t z) {
    for (const std::size_t behind : {0u, 1u}) {
      const auto number_of_slice = static_cast<std::int64_t>(z + behind) + first_[2];
      runs.for_each(number_of_slice, [&](const ClassRun& run, std::uint32_t draw) {
        if (behind == 0) std::fill_n(numbers + place(run, z), run.length, of_draw[draw]);
        for (const std::size_t above : {std::size_t{0}, row})
          merge(place(run, z) - above - 1, run.length + std::size_t{1}, of_draw[draw]);
      });
    }
  });
  numbers_ = std::move(voxels);
  return {};
}

std::vector<std::uint32_t> brick_sums(const BrickMask& mask) {
  const auto row = static_cast<std::size_t>(mask.x + 1);
  const std::size_t slice = row * static_cast<std::size_t>(mask.y + 1);
  std::vector<std::uint32_t> sums(slice * static_cast<std::size_t>(mask.z + 1), 0);
  for (std::int64_t k = 0; k < mask.z; ++k) {
    check_task();
    for (std::int64_t j = 0; j < mask.y; ++j) {
      std::uint32_t in_row = 0;
      for (std::int64_t i = 0; i < mask.x; ++i) {
        in_row += mask.bricks[mask.number(i, j, k)] != 0 ? 1 : 0;
        const std::size_t at = static_cast<std::size_t>(k + 1) * slice +
                               static_cast<std::size_t>(j + 1) * row + static_cast<std::size_t>(i + 1);
        sums[at] = in_row + sums[at - row] + sums[at - slice] - sums[at - slice - row];
      }
    }
  }
  return sums;
}

void mark_slices(BrickMask& mask, const std::vector<std::vector<std::uint8_t>>& slices) {
  const std::size_t bricks = mask.of_slice();
  for (std::size_t slice = 0; slice < slices.size(); ++slice) {
    const std::size_t to = slice / MarchGrid::kBrick;
    const std::size_t from = slice == 0 ? 0 : (slice - 1) / MarchGrid::kBrick;
    for (std::size_t k = from; k <= to; ++k) {
      for (std::size_t n = 0; n < bricks; ++n) mask.bricks[k * bricks + n] |= slices[slice][n];
    }
  }
}

double bytes_of_ray_volume(const MarchGrid& grid, std::uint64_t runs) {
  constexpr double kBytesPerBrick = 16, kBytesPerSlice = 64, kVoxelBytes = 16, kPageBytes = 4096;
  constexpr double kPagesPerRun = 6, kRunBytes = 64;
  double bricks = 1, voxels = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    bricks *= static_cast<double>(grid.bricks(a));
    voxels *= static_cast<double>(grid.size[a]);
  }
  const auto all_runs = static_cast<double>(runs);
  return bricks * kBytesPerBrick + static_cast<double>(grid.size[2]) * kBytesPerSlice + all_runs * kRunBytes +
         std::min(kVoxelBytes * voxels, all_runs * kPagesPerRun * kPageBytes);
}

}  // namespace splatlas

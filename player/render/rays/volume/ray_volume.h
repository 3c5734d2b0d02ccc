// Volume for ray casting: grey values or optical properties of selected voxels in a padded box; bricks.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "format/atlas_reader.h"
#include "format/content/decision_tree.h"
#include "format/content/selection.h"
#include "format/tasks/thread_pool.h"
#include "player/picture.h"
#include "player/render/decode/block_volume.h"
#include "player/render/decode/class_cache.h"
#include "player/render/decode/selected_runs.h"
#include "player/render/light/voxel_light.h"
#include "player/render/rays/march_kernels.h"
#include "player/render/transfer/shading.h"
#include "player/render/transfer/volume_appearances.h"
#include "player/render_options.h"

namespace splatlas {

/// The lit voxels of a block with one colour. Other voxels of the block have light 0.
struct LitBlock {
  std::uint32_t block = 0;             ///< number in its slice; that of a voxel is kBlock times as large
  std::array<float, 3> color{};        ///< linear; emissions are those of white times the colour
  std::array<float, kBlock> whites{};  ///< unlit emissions of white, 1/mm
  std::array<VoxelLight, kBlock> lights{};
};

/// The lit voxels of a slice, by ascending block.
using LitBlocks = std::vector<LitBlock>;

/// The latest block, or a new one with another number or colour. Means of one colour differ by rounding.
[[nodiscard]] inline LitBlock& require_block(LitBlocks& blocks, std::uint32_t block,
                                             const std::array<float, 3>& color) {
  const auto is_same = [](float a, float b) { return std::abs(a - b) < 2e-6f; };
  if (blocks.empty() || blocks.back().block != block ||
      !std::equal(color.begin(), color.end(), blocks.back().color.begin(), is_same)) {
    LitBlock& next = blocks.emplace_back();
    next.block = block;
    next.color = color;
  }
  return blocks.back();
}

/// Upper bound of a ray volume's memory: tables, and pages that these runs touch here and in the class cache.
[[nodiscard]] double bytes_of_ray_volume(const MarchGrid& grid, std::uint64_t runs);

/// One byte per brick, x fastest: nonzero for non-empty bricks.
struct BrickMask {
  explicit BrickMask(const MarchGrid& grid)
      : x(grid.bricks(0)),
        y(grid.bricks(1)),
        z(grid.bricks(2)),
        bricks(static_cast<std::size_t>(x) * static_cast<std::size_t>(y) * static_cast<std::size_t>(z)) {}

  [[nodiscard]] std::size_t number(std::int64_t i, std::int64_t j, std::int64_t k) const {
    return static_cast<std::size_t>((k * y + j) * x + i);
  }

  /// Number of bricks of a slice.
  [[nodiscard]] std::size_t of_slice() const { return number(0, 0, 1); }

  std::int64_t x, y, z;
  std::vector<std::uint8_t> bricks;
};

/// Summed-area table of a mask, as MarchSource::active (Crow 1984): O(1) emptiness test of a box.
[[nodiscard]] std::vector<std::uint32_t> brick_sums(const BrickMask& mask);

/// Minimum and maximum grey value at the corners of the cells of each brick, for one slice of bricks.
class BrickRanges {
 public:
  explicit BrickRanges(const MarchGrid& grid)
      : columns_(grid.bricks(0)),
        rows_(grid.bricks(1)),
        ranges_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_)) {}

  /// Adds `count` voxels along x from (x, y) on; `grey(n)` is the value of the n-th.
  template <typename Grey>
  void include(std::int64_t x, std::int64_t y, std::int64_t count, const Grey& grey) {
    const std::int64_t last_row = std::min(y / kSide, rows_ - 1);
    const std::int64_t first_row = y % kSide == 0 ? std::max<std::int64_t>(last_row - 1, 0) : last_row;
    for (std::int64_t column = std::max<std::int64_t>((x - 1) / kSide, 0);
         column < columns_ && column * kSide < x + count; ++column) {
      const std::int64_t from = std::max(x, column * kSide);
      const std::int64_t to = std::min(x + count, (column + 1) * kSide + 1);
      if (from >= to) continue;
      float low = std::numeric_limits<float>::max(), high = std::numeric_limits<float>::lowest();
      for (std::int64_t at = from; at < to; ++at) {
        const float g = grey(at - x);
        low = std::min(low, g);
        high = std::max(high, g);
      }
      for (std::int64_t row = first_row; row <= last_row; ++row) {
        Range& range = ranges_[static_cast<std::size_t>(row * columns_ + column)];
        range.low = std::min(range.low, low);
        range.high = std::max(range.high, high);
        range.voxels += static_cast<std::int32_t>(to - from);
      }
    }
  }

  /// Range of a brick, including the value 0 of any absent voxels. False for a brick without voxels.
  bool range(std::size_t brick, float& low, float& high) const {
    constexpr std::int64_t kVoxels = (kSide + 1) * (kSide + 1) * (kSide + 1);
    const Range& range = ranges_[brick];
    low = range.voxels < kVoxels ? std::min(range.low, 0.0f) : range.low;
    high = range.voxels < kVoxels ? std::max(range.high, 0.0f) : range.high;
    return range.voxels > 0;
  }

 private:
  static constexpr std::int64_t kSide = MarchGrid::kBrick;
  struct Range {
    float low = std::numeric_limits<float>::max(), high = std::numeric_limits<float>::lowest();
    std::int32_t voxels = 0;
  };
  std::int64_t columns_, rows_;
  std::vector<Range> ranges_;
};

/// Marks the bricks of the cells around a voxel within its slice.
inline void mark_around(const BrickMask& mask, std::vector<std::uint8_t>& bricks, std::int64_t x,
                        std::int64_t y) {
  for (std::int64_t j = (y - 1) / MarchGrid::kBrick; j <= y / MarchGrid::kBrick; ++j) {
    for (std::int64_t i = (x - 1) / MarchGrid::kBrick; i <= x / MarchGrid::kBrick; ++i) {
      bricks[static_cast<std::size_t>(j * mask.x + i)] = 1;
    }
  }
}

/// Marks the bricks of the cells in front of and behind the voxels that mark_around() marked: [slice][brick].
void mark_slices(BrickMask& mask, const std::vector<std::vector<std::uint8_t>>& slices);

/// Input of a ray volume. References must outlive the call.
struct RayVolumeRequest {
  const Atlas& atlas;
  const Selection& selection;
  const DrawPlan& plan;
  std::span<const VolumeAppearance> appearances;  ///< of the plan's classes
  const SelectedRuns& runs;                       ///< of the z axis
  const ClassCache& cache;
  Classification classification = Classification::kBefore;
  bool shade = false;   ///< prepare boundary voxels for shading by their normals
  bool walked = false;  ///< pre-classified, for ids and depths alone: without emissions
  std::uint64_t max_memory_bytes = 0;
  /// Of the plan, runs and cache, which are then pre-classified blocks: their optical properties are those of
  /// the shares that the selection fills. Null: voxels.
  const BlockVolume* blocks = nullptr;

  /// Share of a voxel or block, in memory order of the grid, that the selection fills.
  [[nodiscard]] float share(std::size_t n) const { return blocks != nullptr ? blocks->share(n) : 1; }
  [[nodiscard]] const Grid& grid() const { return blocks != nullptr ? blocks->grid() : atlas.grid(); }
};

/// The sources of a selection. Classes with equal transfer functions share a source. Their grey values are
/// interpolated together, with 0 for all other voxels; their colours are interpolated with the weights of
/// their voxels. Structures that are not post-classified (see grey_scale()) share one source.
class RayVolume {
 public:
  /// kLimit for more memory than allowed, more than kMaxSources different transfer functions, or a box of
  /// more than 2^31 voxels. Cost: linear in the selected voxels and in the bricks of their box. Reads nothing
  /// of unselected classes.
  [[nodiscard]] static Result<RayVolume> build(const RayVolumeRequest& request, ThreadPool& pool);

  /// The means of blocks of 2^level voxels along each axis, as those of CoarseSpans. `runs`: those of the
  /// volume, which must be pre-classified. kLimit when out of address space. Cost: about 30 ns per voxel.
  [[nodiscard]] Result<RayVolume> means(const SelectedRuns& runs, int level, ThreadPool& pool) const;

  /// True if the volume was built for these options, and not for walks alone.
  [[nodiscard]] bool fits(Classification classification, bool shade) const {
    return classification_ == classification && shade_ == shade && voxel_floats_ == kFour;
  }
  /// True if rays can walk through it for ids and depths of unlit voxels.
  [[nodiscard]] bool fits_walk() const { return classification_ == Classification::kBefore && !shade_; }
  /// Lights boundary voxels if the volume was built with `shade` and the view's lighting has changed.
  void light(const ParallelView& view, const Lighting& lighting, ThreadPool& pool);

  /// Stores the structure numbers of the voxels, for id images, unless it has them. `of_draw`: by index into
  /// the plan's classes. kLimit when out of memory. Cost: linear in the selected voxels.
  [[nodiscard]] Result<void> number(const SelectedRuns& runs, std::span<const StructureNumber> of_draw,
                                    ThreadPool& pool);
  /// Structure numbers of the voxels, x fastest; null: none.
  [[nodiscard]] const StructureNumber* numbers() const {
    return reinterpret_cast<const StructureNumber*>(numbers_.data());
  }

  [[nodiscard]] Classification classification() const { return classification_; }
  /// Floats per voxel if pre-classified, the first of them its extinction; null if empty.
  [[nodiscard]] std::size_t voxel_floats() const { return voxel_floats_; }
  [[nodiscard]] const float* extinctions() const {
    return empty() ? nullptr : reinterpret_cast<const float*>(sources_.front().values.data());
  }
  /// The number of all selected corners of each cell; 0 without any, kSeveralNumbers if they differ.
  static constexpr StructureNumber kSeveralNumbers = 0xffff;
  [[nodiscard]] const StructureNumber* cell_numbers() const {
    return reinterpret_cast<const StructureNumber*>(cell_numbers_.data());
  }

  /// True if no voxel is selected.
  [[nodiscard]] bool empty() const { return sources_.empty(); }
  /// Voxel of the grid at position (0, 0, 0).
  [[nodiscard]] const Index3& first() const { return first_; }
  [[nodiscard]] const MarchGrid& grid() const { return grid_; }
  [[nodiscard]] std::span<const MarchSource> sources() const { return views_; }
  /// Non-empty bricks of all sources, as MarchSource::active.
  [[nodiscard]] const std::uint32_t* active() const { return active_.data(); }
  [[nodiscard]] std::uint64_t voxels() const { return voxels_; }
  /// Upper bound of the memory of its voxels.
  [[nodiscard]] std::uint64_t bytes() const { return bytes_ + numbers_.size() + cell_numbers_.size(); }
  /// Number of selected runs.
  [[nodiscard]] std::uint64_t runs() const { return runs_; }

 private:
  struct Source {
    std::unique_ptr<PreintegratedTransfer> transfer;  // null: pre-classified
    GreyScale scale;
    std::vector<bool> draws;  // classes of the plan that belong to it
    std::array<float, 3> color{};
    bool many_colors = false;
    SparseBytes values, colors;
    std::vector<std::uint32_t> active;
    std::vector<LitBlocks> lit;  // by slice, of number()
  };
  class Builder;
  class Averager;
  static constexpr std::size_t kFour = 4;
  /// Padding of the selection's bounding box by empty voxels.
  static constexpr std::int64_t kMargin = 2;

  /// Number of a voxel in its slice of the box.
  [[nodiscard]] std::uint32_t number(std::int64_t x, std::int64_t y) const {
    return static_cast<std::uint32_t>(place(x, y, 0));
  }
  /// Offset of a voxel of the box.
  [[nodiscard]] std::size_t place(std::int64_t x, std::int64_t y, std::int64_t z) const {
    return static_cast<std::size_t>((z * grid_.size[1] + y) * grid_.size[0] + x);
  }

  Index3 first_{};
  std::size_t voxel_floats_ = kFour;
  MarchGrid grid_;
  std::vector<Source> sources_;
  std::vector<MarchSource> views_;
  std::vector<std::uint32_t> active_;
  SparseBytes numbers_, cell_numbers_;
  std::uint64_t runs_ = 0, voxels_ = 0, lit_blocks_ = 0, bytes_ = 0;
  Classification classification_ = Classification::kBefore;
  bool shade_ = false;
  std::optional<ParallelView> lit_for_;  // none: not lit, or partly lit
};

}  // namespace splatlas

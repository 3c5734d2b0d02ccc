// Surface of a structure on a coarser grid, for drafts.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "format/content/grid.h"
#include "format/content/run_model.h"
#include "format/content/surface.h"

namespace splatlas {

/// Share of a structure in blocks of 2^level voxels along each axis, in a box of blocks.
class Coverage {
 public:
  /// Shares have 15 bits, so the voxels of larger blocks would not count.
  static constexpr int kMaxLevel = 5;
  /// Share of a block inside the structure.
  static constexpr std::uint16_t kFull = 1u << (3 * kMaxLevel);
  /// Empty blocks around the box of a structure on every side: cells need one, their gradients another.
  static constexpr std::int64_t kMargin = 2;

  /// No voxels yet in the blocks of `box`, which must not be empty, and in their margin.
  Coverage(const IndexBox& box, int level);
  /// Blocks with margins that a box takes.
  [[nodiscard]] static double blocks(const IndexBox& box, int level);

  /// Adds runs (principal axis z) within the box, in a grid of `rows` rows per slice. O(runs + blocks).
  void add(std::span<const Run> runs, std::int64_t rows);

  [[nodiscard]] int level() const { return level_; }
  [[nodiscard]] const Index3& first() const { return first_; }  ///< block, margin included
  [[nodiscard]] const Index3& size() const { return size_; }    ///< in blocks, margins included
  /// [block, i fastest]
  [[nodiscard]] std::span<const std::uint16_t> shares() const { return shares_; }

 private:
  int level_;
  Index3 first_{}, size_{};
  std::vector<std::uint16_t> shares_;
};

/// Marching cubes (Lorensen and Cline 1987) on the coverage of a whole structure. The isovalue keeps its
/// volume, and ridges of low coverage are raised above it, so that thin parts remain. Normals are Sobel
/// gradients. Nothing if blocks away from the surface's inside hold more than 1 % of the structure. Positions
/// are voxels of `grid`. Vertices are closer than half a voxel to the structure's surface on average at
/// level 1. Cost: linear in the blocks, a few ns each, and about 0.1 us per triangle.
[[nodiscard]] std::optional<SurfaceMesh> coarse_surface(const Coverage& coverage, const Grid& grid);

}  // namespace splatlas

// Volume of a selection in blocks of voxels, for first pictures.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "format/atlas_reader.h"
#include "format/content/decision_tree.h"
#include "format/content/selection.h"
#include "format/tasks/thread_pool.h"
#include "player/render/decode/class_cache.h"
#include "player/render/decode/sparse_bytes.h"

namespace splatlas {

/// The volume classes of a plan in a grid of blocks (format/content/run_model.h), as voxels of a coarser
/// atlas. A block is of the structure with most voxels in it, and has the mean grey value of its largest part
/// there. Structures are divided into interior and boundary blocks anew, with own normals. Not thread-safe.
class BlockVolume {
 public:
  /// Reads runs along z and means. Errors of Atlas::read_means(). Cost: linear in the runs, and about 0.1 us
  /// per block. Throws std::bad_alloc.
  [[nodiscard]] static Result<std::unique_ptr<BlockVolume>> read(std::shared_ptr<const Atlas> atlas,
                                                                 const DrawPlan& plan, ThreadPool& pool);

  /// Makes the runs of an axis, and of z, available in cache().
  void require(Axis axis, ThreadPool& pool);

  [[nodiscard]] const Grid& grid() const { return grid_; }
  [[nodiscard]] const ClassTable& classes() const { return classes_; }
  [[nodiscard]] const DrawPlan& plan() const { return plan_; }
  /// The light of its boundary is that of its normals.
  [[nodiscard]] ClassCache& cache() { return cache_; }
  /// Share of a block, in memory order of the grid, that the plan's voxels fill: 0 to 1.
  [[nodiscard]] float share(std::size_t block) const {
    return static_cast<float>(std::to_integer<int>(covered_.data()[block])) / kVoxels;
  }

 private:
  static constexpr int kVoxels = 1 << (3 * kMeanLevel);
  struct Group;
  struct Structure;

  BlockVolume(std::shared_ptr<const Atlas> atlas, const Grid& grid) : grid_(grid), cache_(std::move(atlas)) {}
  [[nodiscard]] Result<void> divide(std::vector<Group>& groups, VoxelType type, ThreadPool& pool);
  [[nodiscard]] Result<SparseBytes> own_blocks(std::vector<Group>& groups,
                                               const std::vector<Structure>& structures, VoxelType type);
  void add(const ClassDraw& draw, Part part, const ClassRuns& runs);

  Grid grid_;
  ClassTable classes_;
  DrawPlan plan_;
  ClassCache cache_;
  std::vector<ClassRuns> z_runs_;  // [class of the plan]
  std::array<bool, 3> has_runs_{};
  SparseBytes covered_;  // [block]: voxels of the plan
};

}  // namespace splatlas

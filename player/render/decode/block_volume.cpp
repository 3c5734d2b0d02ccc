#include "player/render/decode/block_volume.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <numeric>
#include <utility>

#include "format/derive/boundary_split.h"
#include "format/derive/fit_surface.h"
#include "format/derive/value_groups.h"
#include "format/file/fitted_content.h"
#include "format/result_macros.h"
#include "format/tasks/task_control.h"

namespace splatlas {

/// A group of classes: how it is drawn, its blocks, and those that it owns.
struct BlockVolume::Group {
  ClassDraw draw;
  Result<BlockMeans> means;
  SplitRuns runs;
  std::vector<PackedNormal> normals;  // of runs.boundary
};

namespace {

/// Calls take(block of the grid, n-th block of the group) in order.
template <typename Take>
void for_each_block(const ClassRuns& runs, std::int64_t width, const Take& take) {
  std::size_t n = 0;
  for (const Run& run : runs) {
    const std::size_t first = run.scanline * static_cast<std::size_t>(width) + run.start;
    for (std::size_t block = first; block < first + run.length; ++block) take(block, n++);
  }
}

/// The blocks of runs for which `owns(block)` holds, as maximal runs.
template <typename Owns>
ClassRuns owned_runs(const ClassRuns& all, std::int64_t width, const Owns& owns) {
  ClassRuns runs;
  for_each_block(all, width, [&](std::size_t block, std::size_t /*n*/) {
    if (!owns(block)) return;
    const Run run{block / static_cast<std::size_t>(width),
                  static_cast<std::uint32_t>(block % static_cast<std::size_t>(width)), 1};
    if (!runs.empty() && runs.back().scanline == run.scanline &&
        runs.back().start + runs.back().length == run.start) {
      ++runs.back().length;
    } else {
      runs.push_back(run);
    }
  });
  return runs;
}

std::uint64_t voxels_of(const ClassRuns& runs) {
  return std::accumulate(runs.begin(), runs.end(), std::uint64_t{0},
                         [](std::uint64_t sum, const Run& run) { return sum + run.length; });
}

/// Normals of the boundary of a structure of these blocks.
std::vector<PackedNormal> normals_of(const SplitRuns& of, const Grid& grid) {
  if (of.boundary.empty()) return {};
  const IndexBox box = box_of(of.boundary, grid.size, Axis::kZ);
  if (fits_sparsely(box, voxels_of(of.boundary))) {
    PartRows rows(grid.size);
    rows.add(of.interior, StructureCrop::kInterior);
    rows.add(of.boundary, StructureCrop::kBoundary);
    rows.sort();
    return fit_sparse_normals(rows, of.boundary, grid);
  }
  StructureCrop crop = crop_around(box);
  paint_runs(of.interior, grid.size[1], StructureCrop::kInterior, crop);
  paint_runs(of.boundary, grid.size[1], StructureCrop::kBoundary, crop);
  return fit_normals(crop, of.boundary, grid);
}

}  // namespace

Result<std::unique_ptr<BlockVolume>> BlockVolume::read(std::shared_ptr<const Atlas> atlas,
                                                       const DrawPlan& plan, ThreadPool& pool) {
  // Classes of one group are drawn alike
  const ValueGroups value_groups(atlas->classes());
  std::map<std::uint32_t, ClassDraw> draws;
  for (const ClassDraw& draw : plan.classes) {
    if (draws_volume(draw.role)) draws.try_emplace(value_groups.group_of[draw.id], draw);
  }
  std::vector<Group> groups;
  for (const auto& [number, draw] : draws) groups.push_back({draw, {}, {}, {}});
  pool.for_each(groups.size(),
                [&](std::size_t n) { groups[n].means = atlas->read_means(groups[n].draw.id); });
  for (const Group& group : groups) {
    if (!group.means) return tl::unexpected(group.means.error());
  }
  const VoxelType type = atlas->value_type();
  const Grid grid = coarse_grid(atlas->grid(), kMeanLevel);
  std::unique_ptr<BlockVolume> volume(new BlockVolume(std::move(atlas), grid));
  SPLATLAS_RETURN_IF_ERROR(volume->divide(groups, type, pool));
  return volume;
}

/// Divides the blocks among groups, and those of a group into interior and boundary.
Result<void> BlockVolume::divide(std::vector<Group>& groups, VoxelType type, ThreadPool& pool) {
  const auto blocks = static_cast<std::uint64_t>(grid_.voxels());
  const std::int64_t width = grid_.size[0];
  const std::size_t value_bytes = bytes_of(type);
  SPLATLAS_ASSIGN_OR_RETURN(covered_, SparseBytes::reserve(blocks));
  SPLATLAS_ASSIGN_OR_RETURN(SparseBytes most, SparseBytes::reserve(blocks));  // voxels of the owner
  SPLATLAS_ASSIGN_OR_RETURN(SparseBytes owner_bytes, SparseBytes::reserve(blocks * sizeof(std::uint32_t)));
  SPLATLAS_ASSIGN_OR_RETURN(SparseBytes values, SparseBytes::reserve(blocks * value_bytes));
  SPLATLAS_ASSIGN_OR_RETURN(SparseBytes normals, SparseBytes::reserve(blocks * sizeof(PackedNormal)));
  auto* const owners = reinterpret_cast<std::uint32_t*>(owner_bytes.data());
  for (std::uint32_t g = 0; g < groups.size(); ++g) {
    check_task();
    const BlockMeans& means = *groups[g].means;
    for_each_block(means.runs, width, [&](std::size_t block, std::size_t n) {
      const int voxels = means.voxels[n];
      std::byte& covered = covered_.data()[block];
      covered = static_cast<std::byte>(std::min(std::to_integer<int>(covered) + voxels, kVoxels));
      if (voxels <= std::to_integer<int>(most.data()[block])) return;
      most.data()[block] = static_cast<std::byte>(voxels);
      owners[block] = g;
      std::memcpy(values.data() + block * value_bytes, means.values.data() + n * value_bytes, value_bytes);
    });
  }
  pool.for_each(groups.size(), [&](std::size_t g) {
    Group& group = groups[g];
    const ClassRuns runs =
        owned_runs(group.means->runs, width, [&](std::size_t block) { return owners[block] == g; });
    group.means = {};
    group.runs = split_boundary(runs, grid_.size, Axis::kZ);
    group.normals = normals_of(group.runs, grid_);
  });
  for (const Group& group : groups) {
    const std::byte* next = reinterpret_cast<const std::byte*>(group.normals.data());
    for (const Run& run : group.runs.boundary) {
      const std::size_t first = run.scanline * static_cast<std::size_t>(width) + run.start;
      std::memcpy(normals.data() + first * sizeof(PackedNormal), next, run.length * sizeof(PackedNormal));
      next += run.length * sizeof(PackedNormal);
    }
    add(group.draw, Part::kInterior, group.runs.interior);
    add(group.draw, Part::kBoundary, group.runs.boundary);
  }
  cache_.keep_voxels(std::move(values), std::move(normals));
  return {};
}

void BlockVolume::add(const ClassDraw& draw, Part part, const ClassRuns& runs) {
  if (runs.empty()) return;
  const auto group = static_cast<StructureIndex>(classes_.size());  // any number of its own
  const ClassId id = classes_.intern({{group, part}});
  const std::uint64_t voxels = voxels_of(runs);
  classes_.count(id, voxels, box_of(runs, grid_.size, Axis::kZ));
  plan_.classes.push_back({id, VoxelRole::kVolume, draw.volume_of, part == Part::kBoundary});
  plan_.volume_voxels += voxels;
  z_runs_.push_back(runs);
}

void BlockVolume::require(Axis axis, ThreadPool& pool) {
  if (has_runs_[static_cast<std::size_t>(axis)]) return;
  std::vector<ClassRuns> converted(z_runs_.size());
  pool.for_each(z_runs_.size(),
                [&](std::size_t n) { converted[n] = convert_runs(z_runs_[n], grid_.size, Axis::kZ, axis); });
  std::vector<std::pair<ClassId, const ClassRuns*>> runs;
  for (std::size_t n = 0; n < converted.size(); ++n) runs.emplace_back(plan_.classes[n].id, &converted[n]);
  cache_.keep_runs(runs, axis, grid_.size[ScanOrder::of(axis).row_axis], pool);
  has_runs_[static_cast<std::size_t>(axis)] = true;
}

}  // namespace splatlas

#include "player/render/decode/block_volume.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <numeric>

#include "format/derive/boundary_split.h"
#include "format/derive/fit_surface.h"
#include "format/derive/value_groups.h"
#include "format/file/fitted_content.h"
#include "format/result_macros.h"
#include "format/tasks/task_control.h"

namespace splatlas {

/// A group of classes: its blocks, and those that it owns.
struct BlockVolume::Group {
  ClassDraw draw;
  Result<BlockMeans> means;
  ClassRuns owned;
};
/// Groups [begin, end) with the appearance of one structure.
struct BlockVolume::Structure {
  std::size_t begin = 0, end = 0;
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
  check_memory(crop_bytes(box));
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
  std::map<std::pair<StructureIndex, std::uint32_t>, ClassDraw> draws;
  for (const ClassDraw& draw : plan.classes) {
    if (draws_volume(draw.role)) draws.try_emplace({draw.volume_of, value_groups.group_of[draw.id]}, draw);
  }
  std::vector<Group> groups;
  for (const auto& [key, draw] : draws) groups.push_back({draw, {}, {}});
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

/// Divides the blocks among structures, and those of a structure into interior and boundary.
Result<void> BlockVolume::divide(std::vector<Group>& groups, VoxelType type, ThreadPool& pool) {
  std::vector<Structure> structures;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    if (g == 0 || groups[g].draw.volume_of != groups[g - 1].draw.volume_of)
      structures.push_back({g, g, {}, {}});
    structures.back().end = g + 1;
  }
  SPLATLAS_ASSIGN_OR_RETURN(SparseBytes values, own_blocks(groups, structures, type));
  pool.for_each(structures.size(), [&](std::size_t n) {
    Structure& structure = structures[n];
    ClassRuns runs = std::move(groups[structure.begin].owned);
    for (std::size_t g = structure.begin + 1; g < structure.end; ++g) runs = join_runs(runs, groups[g].owned);
    structure.runs = split_boundary(runs, grid_.size, Axis::kZ);
    structure.normals = normals_of(structure.runs, grid_);
  });
  SPLATLAS_ASSIGN_OR_RETURN(
      SparseBytes lights,
      SparseBytes::reserve(static_cast<std::uint64_t>(grid_.voxels()) * sizeof(VoxelLight)));
  auto* const of_blocks = reinterpret_cast<VoxelLight*>(lights.data());
  for (const Structure& structure : structures) {
    for_each_block(structure.runs.boundary, grid_.size[0], [&](std::size_t block, std::size_t n) {
      of_blocks[block] = {structure.normals[n], VoxelLight::kAllLit};
    });
    add(groups[structure.begin].draw, Part::kInterior, structure.runs.interior);
    add(groups[structure.begin].draw, Part::kBoundary, structure.runs.boundary);
  }
  cache_.keep_voxels(std::move(values), std::move(lights));
  return {};
}

/// Gives each block to the structure with most voxels in it, and there to its group with most of them.
/// Returns the values of the blocks: the means of these groups.
Result<SparseBytes> BlockVolume::own_blocks(std::vector<Group>& groups,
                                            const std::vector<Structure>& structures, VoxelType type) {
  const auto blocks = static_cast<std::uint64_t>(grid_.voxels());
  const std::size_t value_bytes = bytes_of(type);
  SPLATLAS_ASSIGN_OR_RETURN(covered_, SparseBytes::reserve(blocks));
  SPLATLAS_ASSIGN_OR_RETURN(SparseBytes counts, SparseBytes::reserve(blocks));  // of the current structure
  SPLATLAS_ASSIGN_OR_RETURN(SparseBytes most, SparseBytes::reserve(blocks));
  SPLATLAS_ASSIGN_OR_RETURN(SparseBytes owners, SparseBytes::reserve(blocks * sizeof(std::uint32_t)));
  SPLATLAS_ASSIGN_OR_RETURN(SparseBytes values, SparseBytes::reserve(blocks * value_bytes));
  auto* const owner_of = reinterpret_cast<std::uint32_t*>(owners.data());  // groups
  // Calls take(block, voxels of the group, g, n-th block of the group) for the groups of a structure.
  const auto visit = [&](const Structure& structure, const auto& take) {
    check_task();
    for (std::size_t g = structure.begin; g < structure.end; ++g) {
      const std::vector<std::uint8_t>& voxels = groups[g].means->voxels;
      for_each_block(groups[g].means->runs, grid_.size[0],
                     [&](std::size_t block, std::size_t n) { take(block, std::byte{voxels[n]}, g, n); });
    }
  };
  const auto sum = [](std::byte a, std::byte b) {
    return static_cast<std::byte>(std::min(std::to_integer<int>(a) + std::to_integer<int>(b), kVoxels));
  };
  for (const Structure& structure : structures) {
    visit(structure, [&](std::size_t block, std::byte voxels, auto...) {
      covered_.data()[block] = sum(covered_.data()[block], voxels);
      counts.data()[block] = sum(counts.data()[block], voxels);
    });
    visit(structure, [&](std::size_t block, auto...) {
      if (counts.data()[block] <= most.data()[block]) return;
      most.data()[block] = counts.data()[block];
      owner_of[block] = static_cast<std::uint32_t>(structure.begin);
    });
    visit(structure, [&](std::size_t block, auto...) { counts.data()[block] = {}; });
  }
  for (const Structure& structure : structures) {
    visit(structure, [&](std::size_t block, std::byte voxels, std::size_t g, std::size_t n) {
      if (owner_of[block] < structure.begin || owner_of[block] >= structure.end) return;
      if (voxels <= counts.data()[block]) return;
      counts.data()[block] = voxels;
      owner_of[block] = static_cast<std::uint32_t>(g);
      std::memcpy(values.data() + block * value_bytes, groups[g].means->values.data() + n * value_bytes,
                  value_bytes);
    });
  }
  for (std::size_t g = 0; g < groups.size(); ++g) {
    groups[g].owned = owned_runs(groups[g].means->runs, grid_.size[0],
                                 [&](std::size_t block) { return owner_of[block] == g; });
    groups[g].means = {};
  }
  return values;
}

void BlockVolume::add(const ClassDraw& draw, Part part, const ClassRuns& runs) {
  if (runs.empty()) return;
  const ClassId id = classes_.intern({{draw.volume_of, part}});
  const std::uint64_t voxels = voxels_of(runs);
  classes_.count(id, voxels, box_of(runs, grid_.size, Axis::kZ));
  plan_.classes.push_back({id, VoxelRole::kVolume, draw.volume_of, part == Part::kBoundary});
  plan_.volume_voxels += voxels;
  z_runs_.push_back(runs);
}

void BlockVolume::require(Axis axis, ThreadPool& pool) {
  if (has_runs_[static_cast<std::size_t>(axis)]) return;
  if (axis != Axis::kZ) require(Axis::kZ, pool);
  std::vector<ClassRuns> converted(z_runs_.size());
  pool.for_each(z_runs_.size(),
                [&](std::size_t n) { converted[n] = convert_runs(z_runs_[n], grid_.size, Axis::kZ, axis); });
  std::vector<std::pair<ClassId, const ClassRuns*>> runs;
  for (std::size_t n = 0; n < converted.size(); ++n) runs.emplace_back(plan_.classes[n].id, &converted[n]);
  cache_.keep_runs(runs, axis, grid_.size[ScanOrder::of(axis).row_axis], pool);
  has_runs_[static_cast<std::size_t>(axis)] = true;
}

}  // namespace splatlas

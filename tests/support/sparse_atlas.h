// Atlas files of few voxels in large grids, without a class volume.
#pragma once

#include <cstddef>
#include <vector>

#include "format/content/class_table.h"
#include "format/content/grid.h"

namespace splatlas {

/// Boxes of voxels of one structure, apart by at least two voxels and at most two voxels thick along some
/// axis, so that every voxel is a boundary voxel.
using SparseStructure = std::vector<IndexBox>;

/// A file with one class per structure, "s0", "s1" and so on, without grey values. Surfaces and normals are
/// fitted. Structures must not overlap. With `in_one`, a structure "all" before them holds their voxels, too.
/// Cost: linear in the voxels of the boxes. Throws std::runtime_error.
[[nodiscard]] std::vector<std::byte> sparse_atlas(const Index3& size,
                                                  const std::vector<SparseStructure>& structures,
                                                  bool in_one = false);

/// True if boxes are too close for sparse_atlas().
[[nodiscard]] bool are_near(const IndexBox& a, const IndexBox& b);

/// One voxel.
[[nodiscard]] inline IndexBox voxel_box(const Index3& at) {
  return {at, at};
}

}  // namespace splatlas

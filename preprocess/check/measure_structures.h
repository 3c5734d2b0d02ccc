// Measurement of structures: counts, places, pieces and holes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "format/atlas_reader.h"

namespace splatlas {

/// Voxels seen from the front, in square cells of a picture: [row from above] has a bit for each column, the
/// first for the right side of the body.
inline constexpr std::size_t kPictureCells = 64;
using Silhouette = std::array<std::uint64_t, kPictureCells>;

/// Small parts of a structure, and the first voxel of the largest one.
struct SmallParts {
  std::size_t count = 0, voxel = 0;
  std::uint64_t largest = 0;
};

/// Measures of one structure. `sums` are sums over voxels; the others are of the structure alone.
struct StructureMeasures {
  struct Sums {
    std::uint64_t voxels = 0;
    Vec3 index{0, 0, 0};  ///< sums of i, j, k
    IndexBox box;
    Silhouette shape{};

    void add(const Sums& other);
  } sums;
  std::size_t pieces = 0;  ///< face-connected components
  std::size_t holes = 0;   ///< components of voxels in no structure that it encloses alone
  SmallParts stray_pieces, small_holes;
};

/// By pairs of structures, the lower one first: number of voxels, and the first one.
using PairVoxels = std::map<std::pair<StructureIndex, StructureIndex>, std::pair<std::uint64_t, std::size_t>>;

struct AtlasMeasures {
  std::vector<StructureMeasures> structures;  ///< [structure]
  StructureMeasures::Sums all;                ///< voxels in any structure
  PairVoxels touching;                        ///< structures of one colour: voxels of one beside the other
  PairVoxels shared;
  std::map<StructureIndex, Index3> apart;  ///< external surfaces without a structure in their box: its middle
};

/// Cell of a voxel in pictures of a storage grid: column and row.
[[nodiscard]] std::array<std::size_t, 2> cell_of(const Index3& voxel, const Grid& grid);

/// `class_volume`: of read_classes().
[[nodiscard]] AtlasMeasures measure_structures(const Atlas& atlas, std::vector<ClassId> class_volume);

}  // namespace splatlas

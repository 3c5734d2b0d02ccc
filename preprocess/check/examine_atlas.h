// Examination of an atlas: measures of each structure, and what may be a fault.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
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

/// A structure and its measures. A group has no pieces and holes.
struct StructureRow {
  Structure structure;
  bool is_group = false;
  StructureMeasures measures = {};
  double ml = 0;
  std::pair<Vec3, Vec3> box_lps_mm = {};
};

/// A possible fault. Kinds are those of findings.txt, and stable.
struct Finding {
  std::string kind;
  std::size_t count = 1;  ///< of pieces, holes, voxels or structures
  std::string message;    ///< "\"Spleen\": 2 small pieces ..."
  std::string remedy;
  std::vector<std::string> structures;       ///< ids
  std::optional<Vec3> place_lps_mm = {};     ///< without voxels, none
  std::array<std::size_t, 2> cell = {0, 0};  ///< column and row of the place
};

struct Examination {
  std::vector<StructureRow> rows;  ///< [structure]
  std::vector<Finding> findings;   ///< by kind, in the order of findings.txt
  Silhouette shape{};              ///< of all structures
};

/// The front of a nose, halfway up: for 10 mm upwards, the front of the mask rises by 12 mm and more over the
/// points 25 mm to both sides, where the mask is 90 to 230 mm wide. Foreheads, brains and cut faces are
/// flatter. `grid` is a storage grid. Linear in the voxels.
[[nodiscard]] std::optional<Index3> find_nose(std::span<const std::uint8_t> mask, const Grid& grid);

/// Examines an atlas; docs/guide.md has the rules. Linear in voxels, structures and pairs of structures in
/// one class, and the holes. Memory: 4 bytes per voxel, and grey values for heads. Errors of reading.
[[nodiscard]] Result<Examination> examine_atlas(const Atlas& atlas);

}  // namespace splatlas

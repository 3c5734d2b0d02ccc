// Examination of an atlas: a row for each structure, and what may be a fault.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "preprocess/check/measure_structures.h"

namespace splatlas {

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
/// one class, and the holes. Memory: 4 bytes per voxel, and grey values if a name tells of a head. Errors of
/// reading.
[[nodiscard]] Result<Examination> examine_atlas(const Atlas& atlas);

}  // namespace splatlas

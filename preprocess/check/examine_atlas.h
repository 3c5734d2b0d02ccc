// Examination of an atlas: a row for each structure, and what may be a fault.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "preprocess/check/measure_structures.h"

namespace splatlas {

/// What a structure is. A group has no pieces and holes.
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

/// Examines an atlas; docs/guide.md has the rules. Linear in voxels, structures and pairs of structures in
/// one class, and the holes. Memory: 4 bytes per voxel, and grey values if a name tells of a head. Errors of
/// reading.
[[nodiscard]] Result<Examination> examine_atlas(const Atlas& atlas);

}  // namespace splatlas

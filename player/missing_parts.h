// Missing parts of a picture of a damaged file.
#pragma once

#include <cstdint>
#include <string>

#include "format/content/structure_graph.h"
#include "format/result.h"

namespace splatlas {

/// Volume or surface of a selected structure that cannot be read.
struct MissingPart {
  StructureIndex structure = kNoStructure;
  bool surface = false;      ///< true: its surface; false: voxels of its volume
  std::uint64_t voxels = 0;  ///< number of missing voxels; 0 for a surface
  Error error;               ///< error of its first unreadable stream
};

/// One line with structure, part and error, such as: "Vermis_3": its volume of 1234 voxels is missing:
/// a.atlas: damaged: checksum of values of classes 3 to 4.
[[nodiscard]] std::string describe(const MissingPart& missing, const StructureGraph& graph);

}  // namespace splatlas

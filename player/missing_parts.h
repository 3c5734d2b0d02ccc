// Missing parts of a picture of a damaged file.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "format/decision_tree.h"
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

/// Class with unreadable voxels.
struct FailedClass {
  ClassId id = kEmptyClass;
  Error error;
};
/// Structure with an unreadable surface.
struct FailedSurface {
  StructureIndex structure = kNoStructure;
  Error error;
};

/// Removes unreadable classes and surfaces from a plan, and returns them by structure. All classes of the
/// same structures are removed with a class, so interior and boundary are drawn together or not at all.
/// Voxels count for the structure that gives them their appearance. O(classes + surfaces).
[[nodiscard]] std::vector<MissingPart> leave_out(std::span<const FailedClass> failed_classes,
                                                 std::span<const FailedSurface> failed_surfaces,
                                                 const ClassTable& classes, DrawPlan& plan);

}  // namespace splatlas

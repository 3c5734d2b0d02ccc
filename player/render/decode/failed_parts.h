// Unreadable classes and surfaces of a damaged file.
#pragma once

#include <span>
#include <vector>

#include "format/content/decision_tree.h"
#include "player/missing_parts.h"

namespace splatlas {

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

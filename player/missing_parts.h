// What a picture lacks because the file is damaged.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "format/decision_tree.h"
#include "format/result.h"

namespace splatlas {

/// Something of a structure that is selected but cannot be read.
struct MissingPart {
  StructureIndex structure = kNoStructure;
  bool surface = false;      ///< its surface; else voxels of its volume
  std::uint64_t voxels = 0;  ///< of its volume
  Error error;               ///< of the first of its streams that could not be read
};

/// What is missing and why, in one line: "Vermis_3": its volume of 1234 voxels is missing: a.atlas: damaged:
/// checksum of values of classes 3 to 4.
[[nodiscard]] std::string describe(const MissingPart& missing, const StructureGraph& graph);

struct FailedClass {
  ClassId id = kEmptyClass;
  Error error;
};
struct FailedSurface {
  StructureIndex structure = kNoStructure;
  Error error;
};

/// Takes what could not be read out of a plan: classes with all others of the same structures, so that no
/// structure is drawn without its boundary or without its interior, and surfaces. Returns what that is, by
/// structure: voxels count for the structure that they have their look from.
[[nodiscard]] std::vector<MissingPart> leave_out(std::span<const FailedClass> failed_classes,
                                                 std::span<const FailedSurface> failed_surfaces,
                                                 const ClassTable& classes, DrawPlan& plan);

}  // namespace splatlas

// Segments and fragments of a build.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "preprocess/sources/import_sources.h"
#include "preprocess/structures/build_graph.h"

namespace splatlas {

/// Rule of one --drop-fragments option.
struct FragmentRule {
  std::string name;         ///< of a label, mask or segment; empty for all others
  std::uint64_t below = 0;  ///< components of fewer voxels are dropped
};

/// Parses N or NAME=N, N from 0 to 2^40; kUsage otherwise.
[[nodiscard]] Result<FragmentRule> parse_fragments(std::string_view text);

/// Drops fragments of labels and masks, then adds the segments in their order. A segment gets only voxels
/// that no structure but isosurfaces contains yet, or all of its mask if its rule overlaps; its opening and
/// its rule of fragments follow. Dropped voxels may get into later segments. An isosurface gets all voxels
/// from its level on, within its enclosing structure and the descendants of it. Adds a note on dropped
/// fragments, and one on those of fewer than 100 voxels of structures without a rule. kUsage for names that
/// are no label, mask or segment, kNotFound for unknown enclosing structures, kLimit for isosurfaces in a
/// grid above kMaxIsosurfaceSize. `progress` receives the fraction done.
[[nodiscard]] Result<void> segment_structures(SourceModel& model, const PlacedStructures& placed,
                                              const Grid& grid, const std::vector<FragmentRule>& rules,
                                              const std::function<void(double)>& progress, Notes& notes);

}  // namespace splatlas

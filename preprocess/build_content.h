// Conversion of imported sources to atlas content.
#pragma once

#include "format/atlas_content.h"
#include "preprocess/build_progress.h"
#include "preprocess/import_sources.h"

namespace splatlas {

/// Builds the structure graph, runs segmentations, classifies the voxels and extracts surfaces. Fills only
/// the hashes of the provenance. Appends to `notes` and reports stages to `clock`. The content does not
/// depend on `threads` (0: one per core).
[[nodiscard]] Result<AtlasContent> build_content(SourceModel model, unsigned threads, StageClock& clock,
                                                 std::vector<std::string>& notes);

}  // namespace splatlas

// From sources in memory to the content of an atlas.
#pragma once

#include "format/atlas_content.h"
#include "preprocess/build_progress.h"
#include "preprocess/import_sources.h"

namespace splatlas {

/// Places the structures in the graph, segments what is to be segmented, classifies the voxels, and fits the
/// surfaces. Provenance keeps the sources' hashes only: titles and the like are the caller's. Adds to
/// `notes`. The content does not depend on `threads` (0: all cores). Stages are reported to `clock`.
[[nodiscard]] Result<AtlasContent> build_content(SourceModel model, unsigned threads, StageClock& clock,
                                                 std::vector<std::string>& notes);

}  // namespace splatlas

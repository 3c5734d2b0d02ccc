// Import of all source files of a build.
#pragma once

#include <functional>
#include <vector>

#include "preprocess/import/notes.h"
#include "preprocess/sources/source_model.h"

namespace splatlas {

/// Reads and checks the files, all of them even if one fails: the error is the first one, and `notes` has the
/// others. Masks of segments on other grids are resampled to the nearest voxel. `progress` receives the
/// fraction done and may be empty. Call it while this process has one thread (isolation/run_isolated.h).
[[nodiscard]] Result<SourceModel> import_sources(const SourceFiles& files, Notes& notes,
                                                 const std::function<void(double)>& progress = {});

/// All files that import_sources() would read, including those in folders.
[[nodiscard]] std::vector<std::filesystem::path> list_files(const SourceFiles& files);

}  // namespace splatlas

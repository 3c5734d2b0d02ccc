// Atlases of benches.
#pragma once

#include <filesystem>
#include <memory>

#include "bench/bench.h"
#include "format/atlas_reader.h"
#include "preprocess/atlas/build_atlas.h"
#include "preprocess/sources/import_sources.h"

namespace splatlas {

/// Builds an atlas file.
Result<BuildReport> build_file(const SourceFiles& sources, const std::filesystem::path& output,
                               bool compact = false);

// Both open options.atlas if it is set. Otherwise they build the atlas through the preprocess library into a
// temporary file, which they remove once it is open.

/// The golden phantom.
[[nodiscard]] Result<std::shared_ptr<const Atlas>> open_phantom(const BenchOptions& options);

/// Colin 27 with AAL labels, from Debian's package mricron-data.
[[nodiscard]] Result<std::shared_ptr<const Atlas>> open_colin27(const BenchOptions& options);

/// Sources of the atlas of open_colin27(), as in scripts/demo.sh: labels, tree, brain and head.
[[nodiscard]] Result<SourceFiles> colin27_sources();
/// The Colin 27 volume with AAL labels and names only: 116 structures.
[[nodiscard]] SourceFiles aal_sources();

}  // namespace splatlas

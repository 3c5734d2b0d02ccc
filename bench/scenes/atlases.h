// Atlases of benches.
#pragma once

#include <filesystem>
#include <memory>

#include "bench/bench.h"
#include "format/atlas_reader.h"
#include "preprocess/sources/import_sources.h"

namespace splatlas {

// Both open options.atlas if it is set. Otherwise they build the atlas through the preprocess library into a
// temporary file, which they remove once it is open.

/// The golden phantom.
[[nodiscard]] Result<std::shared_ptr<const Atlas>> open_phantom(const BenchOptions& options);

/// Colin 27 with AAL labels, from Debian's package mricron-data. kFailed names a missing file.
[[nodiscard]] Result<std::shared_ptr<const Atlas>> open_colin27(const BenchOptions& options);

/// The folder of the volumes of mricron-data.
[[nodiscard]] std::filesystem::path templates_folder();
/// Sources of the atlas of open_colin27(), as in scripts/demo.sh: labels, tree, brain and head.
[[nodiscard]] Result<SourceFiles> colin27_sources();
/// The Colin 27 volume with AAL labels and names only: 116 structures.
[[nodiscard]] Result<SourceFiles> aal_sources();

}  // namespace splatlas

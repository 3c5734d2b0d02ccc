// The atlases that benches draw.
#pragma once

#include <filesystem>
#include <memory>

#include "bench/bench.h"
#include "format/atlas_reader.h"
#include "preprocess/import_sources.h"

namespace splatlas {

// Both open options.atlas where it is given; else they build the atlas through the preprocess library into a
// temporary file, which is removed as soon as it is open.

/// The golden phantom.
[[nodiscard]] Result<std::shared_ptr<const Atlas>> open_phantom(const BenchOptions& options);

/// Colin 27 with AAL's labels, of Debian's package mricron-data. kFailed names the file that is missing.
[[nodiscard]] Result<std::shared_ptr<const Atlas>> open_colin27(const BenchOptions& options);

/// Where mricron-data has its volumes.
[[nodiscard]] std::filesystem::path templates_folder();
/// The files and rules of open_colin27()'s atlas, as scripts/demo.sh has them: a tree, brain and head too.
[[nodiscard]] Result<SourceFiles> colin27_sources();
/// Colin 27's volume and AAL's labels and names: 116 structures and nothing else.
[[nodiscard]] Result<SourceFiles> aal_sources();

}  // namespace splatlas

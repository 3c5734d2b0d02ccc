// The atlases that benches draw.
#pragma once

#include <memory>

#include "bench/bench.h"
#include "format/atlas_reader.h"

namespace splatlas {

// Both open options.atlas where it is given; else they build the atlas through the preprocess library into a
// temporary file, which is removed as soon as it is open.

/// The golden phantom.
[[nodiscard]] Result<std::shared_ptr<const Atlas>> open_phantom(const BenchOptions& options);

/// Colin 27 with AAL's labels, of Debian's package mricron-data. kFailed names the file that is missing.
[[nodiscard]] Result<std::shared_ptr<const Atlas>> open_colin27(const BenchOptions& options);

}  // namespace splatlas

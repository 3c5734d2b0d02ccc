// Time to decode a whole atlas, against common exchange files.
#pragma once

#include <filesystem>

#include "bench/bench.h"

namespace splatlas {

/// Decodes the whole atlas of aal_sources(), against gunzip of its volume and labels and, if available, the
/// Draco decoder of its surfaces. Reopens files in each turn. CPU time of one thread.
[[nodiscard]] Result<Table> measure_decoding(const std::filesystem::path& file, const BenchOptions& options,
                                             nlohmann::ordered_json& summary);

}  // namespace splatlas

// What decoding a whole atlas takes, beside the files that people exchange instead.
#pragma once

#include <filesystem>

#include "bench/bench.h"

namespace splatlas {

/// All of the atlas of aal_sources() against gunzip of its volume and labels and, where Draco is there, its
/// decoder of the atlas's surfaces; opened anew for each turn, one thread each. CPU time.
[[nodiscard]] Result<Table> measure_decoding(const std::filesystem::path& file, const BenchOptions& options,
                                             nlohmann::ordered_json& summary);

}  // namespace splatlas

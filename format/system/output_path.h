// Where output goes, and that it does not go over something else.
#pragma once

#include <filesystem>
#include <span>

#include "format/result.h"

namespace splatlas {

/// The file that writing to `path` makes or replaces: links are followed, also those to files that are not
/// there yet. Absolute, unless its folder does not exist.
[[nodiscard]] std::filesystem::path resolve_output(const std::filesystem::path& path);

/// The same file, by whatever path: through links, hard links, and also when it is not there yet.
[[nodiscard]] bool is_same_file(const std::filesystem::path& a, const std::filesystem::path& b);

/// kUsage when an output is an input or another output. Reads nothing. Empty paths are none.
[[nodiscard]] Result<void> check_outputs(std::span<const std::filesystem::path> outputs,
                                         std::span<const std::filesystem::path> inputs);

}  // namespace splatlas

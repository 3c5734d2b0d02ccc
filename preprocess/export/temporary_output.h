// Atomic file output for libraries that write to a path.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "format/result.h"

namespace splatlas {

/// Calls write(temporary) with a path of the same extension, and replaces `path` atomically on success
/// (OutputFile).
[[nodiscard]] Result<void> write_atomically(
    const std::filesystem::path& path,
    const std::function<Result<void>(const std::filesystem::path&)>& write);

/// Replaces the temporary path in `message` by `path`.
[[nodiscard]] std::string with_path(std::string message, const std::filesystem::path& temporary,
                                    const std::filesystem::path& path);

}  // namespace splatlas

// A file under a temporary name until it is complete.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "format/result.h"

namespace splatlas {

/// An OutputFile for libraries that write to a path and choose formats by its ending: calls write(temporary),
/// and commits when that succeeds. `path` is the old file or the complete new one.
[[nodiscard]] Result<void> write_by_way_of_temporary(
    const std::filesystem::path& path,
    const std::function<Result<void>(const std::filesystem::path&)>& write);

/// `message` with `path` wherever it names the temporary file: what users see is what they asked for.
[[nodiscard]] std::string with_path(std::string message, const std::filesystem::path& temporary,
                                    const std::filesystem::path& path);

}  // namespace splatlas

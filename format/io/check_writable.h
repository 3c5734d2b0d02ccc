// Early checks that outputs can be written.
#pragma once

#include <filesystem>

#include "format/result.h"

namespace splatlas {

/// Checks that a file can be created or replaced. kFailed, with the reason, if its folder is missing or
/// read-only, or if `path` is not a regular file; kUsage for an empty path. Changes nothing.
[[nodiscard]] Result<void> check_writable_file(const std::filesystem::path& path);

/// Checks that a folder can be created. It must not exist, or be empty. Errors as above.
[[nodiscard]] Result<void> check_writable_folder(const std::filesystem::path& path);

/// Removes a trailing slash: "masks" for "masks/".
[[nodiscard]] std::filesystem::path without_end_slash(const std::filesystem::path& folder);

}  // namespace splatlas

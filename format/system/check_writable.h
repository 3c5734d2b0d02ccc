// Whether an output can be written, told before any work is done.
#pragma once

#include <filesystem>

#include "format/result.h"

namespace splatlas {

/// kFailed, with the reason, when no file can be made or replaced at `path`: its folder is missing or may not
/// be written to, or something that is no regular file stands there; kUsage for no path. Changes nothing.
[[nodiscard]] Result<void> check_writable_file(const std::filesystem::path& path);

/// The same for a folder that is to appear: it must not exist yet, or be empty.
[[nodiscard]] Result<void> check_writable_folder(const std::filesystem::path& path);

/// "masks" for "masks/".
[[nodiscard]] std::filesystem::path without_end_slash(const std::filesystem::path& folder);

}  // namespace splatlas

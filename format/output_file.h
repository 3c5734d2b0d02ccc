// Writes a whole file, or none.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

#include "format/result.h"

namespace splatlas {

/// Writes `bytes` to a temporary file beside `path`, syncs it, renames it to `path` and syncs the folder.
/// Whatever happens, `path` is the old file or the complete new one, and on failure (kFailed) no temporary is
/// left. A link is followed; an old file's permissions are kept; anything but a regular file is refused.
[[nodiscard]] Result<void> write_file(const std::filesystem::path& path, std::span<const std::byte> bytes);

}  // namespace splatlas

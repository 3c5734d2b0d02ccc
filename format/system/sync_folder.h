// Durable renames: fsync of folders.
#pragma once

#include <filesystem>

#include "format/result.h"

namespace splatlas {

/// Syncs the folder of the renamed, complete file `target`. Messages call it `path`.
[[nodiscard]] Result<void> sync_folder_of(const std::filesystem::path& target,
                                          const std::filesystem::path& path);

}  // namespace splatlas

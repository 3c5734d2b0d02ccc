// Makes a rename last.
#pragma once

#include <filesystem>

#include "format/result.h"

namespace splatlas {

/// Syncs the folder of `target`, which has just got this name and is whole. `path` is its name for messages.
[[nodiscard]] Result<void> sync_folder_of(const std::filesystem::path& target,
                                          const std::filesystem::path& path);

}  // namespace splatlas

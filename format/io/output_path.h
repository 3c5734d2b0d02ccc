// Resolution of output paths, and detection of conflicts with inputs and other outputs.
#pragma once

#include <filesystem>
#include <span>
#include <string_view>

#include "format/result.h"

namespace splatlas {

/// Resolves links to the file that writing to `path` creates or replaces; the file need not exist. Absolute,
/// unless its folder does not exist.
[[nodiscard]] std::filesystem::path resolve_output(const std::filesystem::path& path);

/// kFailed: "PATH: cannot be written: " and the reason.
[[nodiscard]] tl::unexpected<Error> cannot_write(const std::filesystem::path& path, std::string_view reason);

/// kFailed: the file is complete, but its folder was not synced.
[[nodiscard]] tl::unexpected<Error> cannot_sync_folder(const std::filesystem::path& path,
                                                       std::string_view reason);

/// True for two paths to the same file, through links or hard links. The file need not exist.
[[nodiscard]] bool is_same_file(const std::filesystem::path& a, const std::filesystem::path& b);

/// kUsage if an output is an input or another output. Ignores empty paths. Opens no file.
[[nodiscard]] Result<void> check_outputs(std::span<const std::filesystem::path> outputs,
                                         std::span<const std::filesystem::path> inputs);

}  // namespace splatlas

// Early checks of output paths: that they can be written, and are neither inputs nor other outputs.
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

/// Checks that a file can be created or replaced. kFailed, with the reason, if its folder is missing or
/// read-only, or if `path` is not a regular file; kUsage for an empty path. Changes nothing.
[[nodiscard]] Result<void> check_writable_file(const std::filesystem::path& path);

/// Checks that a folder can be created. It must not exist, or be empty. Errors as above.
[[nodiscard]] Result<void> check_writable_folder(const std::filesystem::path& path);

/// kUsage if an output is an input or another output, by any path or link. Ignores empty ones. Opens none.
[[nodiscard]] Result<void> check_outputs(std::span<const std::filesystem::path> outputs,
                                         std::span<const std::filesystem::path> inputs);

}  // namespace splatlas

// Check of PNG files before libpng reads them.
#pragma once

#include <filesystem>

#include "format/result.h"

namespace splatlas {

/// kFailed for a file that is cut, or has a chunk with a wrong checksum: libpng ends the process at such
/// files, because ITK's reader of headers has no place to return to. Cost: one pass.
[[nodiscard]] Result<void> check_png(const std::filesystem::path& path);

}  // namespace splatlas

// Small source files of every kind, made by our own writers.
#pragma once

#include <filesystem>

namespace splatlas {

/// Writes the files and folders below `folder`. Throws std::runtime_error.
void write_own_imports(const std::filesystem::path& folder);

}  // namespace splatlas

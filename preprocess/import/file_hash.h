// File hashes for provenance.
#pragma once

#include <filesystem>
#include <string>

#include "format/result.h"

namespace splatlas {

/// "xxh64:" and 16 hexadecimal digits, as printed by `xxh64sum FILE`. Reads the file once; of a folder all
/// regular files, in the order of their paths, as one. kFailed if one cannot be read.
[[nodiscard]] Result<std::string> hash_file(const std::filesystem::path& path);

}  // namespace splatlas

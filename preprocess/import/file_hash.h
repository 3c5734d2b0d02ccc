// Says which bytes an atlas was made from.
#pragma once

#include <filesystem>
#include <string>

#include "format/result.h"

namespace splatlas {

/// "xxh64:" and the 16 hexadecimal digits that `xxh64sum FILE` prints. Cost: reads the file once.
[[nodiscard]] Result<std::string> hash_file(const std::filesystem::path& path);

}  // namespace splatlas

// Repeatable options of the form NAME=FILE.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

#include "format/result.h"

namespace splatlas {

/// Splits at the first "="; kUsage, with the option's name, if a side is empty.
[[nodiscard]] Result<std::pair<std::string, std::filesystem::path>> parse_name_and_file(
    std::string_view option, std::string_view text);

}  // namespace splatlas

#include "preprocess/commands/name_and_file.h"

#include "format/system/result_macros.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {

Result<std::pair<std::string, std::filesystem::path>> parse_name_and_file(std::string_view option,
                                                                          std::string_view text) {
  const std::size_t equals = text.find('=');
  const std::string_view name = trimmed(text.substr(0, equals));
  if (equals == std::string_view::npos || name.empty() || equals + 1 == text.size()) {
    return fail(ErrorCode::kUsage, "{} '{}': must be NAME=FILE", option, text);
  }
  return std::pair(std::string(name), std::filesystem::path(text.substr(equals + 1)));
}

}  // namespace splatlas

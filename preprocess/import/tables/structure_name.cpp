#include "preprocess/import/tables/structure_name.h"

#include <fmt/format.h>
#include <utf8cpp/utf8.h>

#include "format/system/ascii_text.h"
#include "format/system/result_macros.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {

Result<void> check_structure_name(std::string_view name) {
  const auto refuse = [&](const std::string& what) {
    return fail(ErrorCode::kFailed, "the name {} {}", in_quotes(name), what);
  };
  if (trimmed(name).empty()) return refuse("is empty");
  if (const std::string fault = fault_of_text(name); !fault.empty()) return refuse(fault);
  if (name.find_first_of("\t\n") != std::string_view::npos) return refuse("holds a tab or a newline");
  if (const auto characters = static_cast<std::size_t>(utf8::distance(name.begin(), name.end()));
      characters > kMaxNameCharacters) {
    return refuse(fmt::format("has {} characters; at most {}", characters, kMaxNameCharacters));
  }
  return {};
}

std::string name_key(std::string_view name) {
  return to_lower(trimmed(name));
}

}  // namespace splatlas

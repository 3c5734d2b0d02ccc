#include "preprocess/import/tables/structure_name.h"

#include <fmt/format.h>
#include <utf8cpp/utf8.h>

#include "format/result_macros.h"
#include "format/text/ascii_text.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {

Result<void> check_structure_name(std::string_view name) {
  const auto refuse = [&](const std::string& what) {
    return fail(ErrorCode::kFailed, "the name {} {}", in_quotes(name), what);
  };
  if (trimmed(name).empty()) return refuse("is empty");
  if (const std::string fault = fault_of_text(name); !fault.empty()) return refuse(fault);
  if (const std::size_t at = name.find_first_of("\t\n"); at != std::string_view::npos) {
    const auto before = utf8::distance(name.begin(), name.begin() + static_cast<std::ptrdiff_t>(at));
    return refuse(fmt::format("holds a {} as character {}; write a blank instead",
                              name[at] == '\t' ? "tab" : "line feed", before + 1));
  }
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

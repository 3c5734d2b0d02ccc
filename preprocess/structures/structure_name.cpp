#include "preprocess/structures/structure_name.h"

#include <algorithm>

#include <fmt/format.h>
#include <utf8cpp/utf8.h>

#include "format/ascii_text.h"
#include "preprocess/import/text_file.h"

namespace splatlas {

Result<void> check_structure_name(std::string_view name) {
  const auto refuse = [&](const std::string& what) {
    return fail(ErrorCode::kFailed, fmt::format("the name {} {}", in_quotes(name), what));
  };
  const auto is_control = [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte < 0x20 || byte == 0x7f;
  };
  if (trimmed(name).empty()) return refuse("is empty");
  if (!utf8::is_valid(name.begin(), name.end())) return refuse("is not UTF-8 text");
  if (std::ranges::any_of(name, is_control)) return refuse("holds a control character (a tab, a newline)");
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

// JSON documents as text.
#pragma once

#include <string>

#include "format/text/ascii_text.h"

namespace splatlas {

/// A document of nlohmann::json with a line feed at its end, safe to print: unsafe characters are escaped,
/// see escaped_json(). Replaces invalid UTF-8, which names of files may have, instead of throwing. `indent`:
/// blanks of a level; -1 for one line.
template <typename Json>
[[nodiscard]] std::string json_text(const Json& json, int indent = 2) {
  return escaped_json(json.dump(indent, ' ', false, Json::error_handler_t::replace)) + "\n";
}

}  // namespace splatlas

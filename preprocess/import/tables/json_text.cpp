#include "preprocess/import/tables/json_text.h"

#include <fmt/format.h>

#include "preprocess/import/tables/text_file.h"

namespace splatlas {

Result<Json> parse_json(const NamesInput& input) {
  try {
    return Json::parse(input.text);
  } catch (const nlohmann::json::parse_error& error) {
    return input.refuse(fmt::format("byte {} is no JSON; correct it, or write the file again", error.byte));
  } catch (const nlohmann::json::exception& error) {  // for example a number beyond a double
    return input.refuse(fmt::format("is no usable JSON (error {}); write the file again", error.id));
  }
}

bool is_json(std::string_view head) {
  const std::string_view text = trimmed(head);
  return text.starts_with('{') || text.starts_with('[');
}

bool has_json_key(std::string_view head, std::string_view key) {
  const std::string quoted = fmt::format("\"{}\"", key);
  for (std::size_t at = head.find(quoted); at != std::string_view::npos; at = head.find(quoted, at + 1)) {
    if (trimmed(head.substr(at + quoted.size(), 8)).starts_with(':')) return true;
  }
  return false;
}

std::string text_of(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_object() || value.is_null()) return {};
  if (!value.is_array()) return value.dump();
  std::string list;
  for (const Json& part : value) list += (list.empty() ? "" : ", ") + (part.is_array() ? "" : text_of(part));
  return "[" + list + "]";
}

std::string text_at(const Json& object, const char* key) {
  if (!object.is_object()) return {};
  const auto found = object.find(key);
  return found == object.end() ? std::string() : text_of(*found);
}

Table::Row row_of(const Json& object, std::size_t number, const std::vector<std::string>& columns) {
  Table::Row row{number, {}};
  for (const std::string& column : columns) row.fields.push_back(text_at(object, column.c_str()));
  return row;
}

}  // namespace splatlas

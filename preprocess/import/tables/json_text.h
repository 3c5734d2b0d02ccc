// Values of JSON files as text.
#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "preprocess/import/tables/names_collector.h"
#include "preprocess/import/tables/table.h"

namespace splatlas {

/// Keeps the order of the file: numbers of entries follow it.
using Json = nlohmann::ordered_json;

/// Parses a JSON file. kFailed, with the position, for a syntax error.
[[nodiscard]] Result<Json> parse_json(const NamesInput& input);

/// True if the first character that is no blank begins an object or a list.
[[nodiscard]] bool is_json(std::string_view head);

/// True if the text holds the key of a member: "key" and a colon.
[[nodiscard]] bool has_json_key(std::string_view head, std::string_view key);

/// A scalar or flat list as text: 17, "[1, 2]"; "" for null and objects.
[[nodiscard]] std::string text_of(const Json& value);

/// The text of a member of an object; "" if it has none.
[[nodiscard]] std::string text_at(const Json& object, const char* key);

/// A row of the members that a table reader knows. `columns` names them.
[[nodiscard]] Table::Row row_of(const Json& object, std::size_t number,
                                const std::vector<std::string>& columns);

}  // namespace splatlas

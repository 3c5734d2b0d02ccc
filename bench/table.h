// Tables as text and JSON.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace splatlas {

/// One row: named cells in column order; numbers, strings, or null for empty cells.
using Row = nlohmann::ordered_json;

/// A table. Columns are the keys of the rows, in order of first occurrence.
struct Table {
  std::string name;                ///< short; in JSON every row carries it as "table"
  std::string title;               ///< subject of the table
  std::vector<std::string> notes;  ///< lines below it, in text only
  std::vector<Row> rows;
};

/// Title, aligned columns (numbers to the right) and notes. Non-integers have three to four significant
/// digits.
[[nodiscard]] std::string to_text(const Table& table);

}  // namespace splatlas

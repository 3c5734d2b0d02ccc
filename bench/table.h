// Tables for people and for programs.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace splatlas {

/// One row: named cells in the order of the columns; numbers, strings, or null where there is nothing to say.
using Row = nlohmann::ordered_json;

/// Rows of one kind. Columns are the keys of the rows in the order in which they first occur.
struct Table {
  std::string name;                ///< short; in JSON every row carries it as "table"
  std::string title;               ///< what the table shows
  std::vector<std::string> notes;  ///< lines below it, in text only
  std::vector<Row> rows;
};

/// Title, aligned columns (numbers to the right) and notes. Numbers that are no integers are given with three
/// to four significant digits.
[[nodiscard]] std::string to_text(const Table& table);

}  // namespace splatlas

// Tables of text: rows of fields below a header.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace splatlas {

/// A table; rows may have fewer fields than columns.
struct Table {
  struct Row {
    std::size_t line = 0;  ///< in the file, from 1; of JSON: number of the entry
    std::vector<std::string> fields;
  };
  struct Fault {
    std::size_t line;
    std::string text;
  };
  std::vector<std::string> columns;
  std::vector<Row> rows;
  std::vector<Fault> faults;  ///< rows that cannot be split
};

/// The separator of the first line that is neither blank nor a comment: tab, semicolon or comma, whichever is
/// most frequent outside quotes. Nullopt without one.
[[nodiscard]] std::optional<char> find_separator(std::string_view text);

/// Splits text by RFC 4180: fields in double quotes may hold separators, line ends and doubled quotes. Also
/// trims fields, and skips blank lines and comments. A comment starts with "#"; below the header, it has no
/// separator. The first record is the header. Faults are rows with more fields than columns, and quotes
/// without an end. O(text).
[[nodiscard]] Table parse_table(std::string_view text, char separator);

}  // namespace splatlas

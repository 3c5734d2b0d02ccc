// Tables of text: rows of fields below a header, the meaning of columns, the structures they describe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "preprocess/import/tables/names_collector.h"

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

enum class ColumnRole : std::uint8_t {
  kUnknown,
  kUnused,  ///< known, but of no use: alpha, visibility
  kLabel,
  kKey,  ///< "id": identifies a row, and is its label where no other column is
  kName,
  kColor,
  kRed,
  kGreen,
  kBlue,
  kParent,
  kPath,
  kLevel,       ///< a name of the path, from the root: "level1"
  kCode,        ///< number of a region, for trees
  kSynonym,     ///< several, separated by ";" or "|"
  kTerm,        ///< code or name in `vocabulary`
  kScheme,      ///< coding scheme of the code `vocabulary` ("" or "region")
  kSchemeCode,  ///< code in that scheme
};

/// A column, by its name in the header.
struct Column {
  ColumnRole role = ColumnRole::kUnknown;
  std::string vocabulary;
};

/// The role of a column by its name. Ignores case, and takes " ", "-", "." and ":" as "_".
[[nodiscard]] Column column_of(std::string_view name);

/// Index of the column of a role, or npos. Of several labels, the most explicit counts ("label" before
/// "value"); otherwise the first.
[[nodiscard]] std::size_t find_column(std::span<const Column> columns, ColumnRole role);
[[nodiscard]] inline bool has_column(std::span<const Column> columns, ColumnRole role) {
  return find_column(columns, role) != std::string::npos;
}

/// Roles of all columns of a table by their names, and else by their values: one column each for label, key,
/// name and so on. A "label" column with text is the name if no other is. Without labels, the only column of
/// unique whole numbers has them; without names or colours, the first column of text or of colours has these.
[[nodiscard]] std::vector<Column> columns_of(const Table& table);

/// Turns the header of a table that has none into its first row. Its columns get names by their values:
/// label, name, colour or three channels, and code.
void add_header(Table& table);

/// A row, with its place in a hierarchy as the file writes it.
struct TableEntry {
  LabelName name;            ///< without label
  std::string label;         ///< as the file writes it; empty if there is none
  std::string key;           ///< id or label; empty if there is none
  std::string parent, path;  ///< empty if there is none
};

/// Entries of a table.
struct TableEntries {
  bool has_labels = false;     ///< a column has them
  bool has_hierarchy = false;  ///< a column has parents or paths
  std::vector<TableEntry> entries;
};

/// Reads the rows; `into` counts faulty ones, colours that cannot be read, and unknown columns. kFailed if
/// there is no column of names or labels, or if only some of red, green and blue are columns.
[[nodiscard]] Result<TableEntries> read_entries(const Table& table, const NamesInput& input,
                                                NamesCollector& into);

/// Adds the entries of a table as names, and their hierarchy. Entries of groups have no label.
[[nodiscard]] Result<void> add_table(const Table& table, const NamesInput& input, NamesCollector& into);

/// Nodes of the entries. Parents are ids, abbreviations or names; those that are no entries become groups.
/// Paths consist of ids ("/997/8/", "[997, 8]") or names ("Brain/Left"). O(entries and path parts).
[[nodiscard]] std::vector<TreeLine> hierarchy_of(const TableEntries& entries);

}  // namespace splatlas

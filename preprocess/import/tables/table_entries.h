// Structures that the rows of a table describe.
#pragma once

#include <string>
#include <vector>

#include "preprocess/import/tables/names_collector.h"
#include "preprocess/import/tables/table.h"

namespace splatlas {

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

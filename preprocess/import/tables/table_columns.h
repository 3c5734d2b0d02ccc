// Meaning of the columns of names tables.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "preprocess/import/tables/table.h"

namespace splatlas {

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

/// Roles of all columns of a table: one column each for label, key, name and so on. A "label" column with
/// text is the name if no other is.
[[nodiscard]] std::vector<Column> columns_of(const Table& table);

}  // namespace splatlas

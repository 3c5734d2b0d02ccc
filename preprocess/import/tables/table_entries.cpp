#include "preprocess/import/tables/table_entries.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "format/result_macros.h"
#include "format/text/ascii_text.h"
#include "preprocess/import/tables/color_text.h"
#include "preprocess/import/tables/table_columns.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

/// Reads rows by the roles of their columns.
class EntryReader {
 public:
  EntryReader(const Table& table, NamesCollector& into)
      : columns_(columns_of(table)), names_(table.columns), into_(into) {}

  /// kFailed if columns are missing.
  Result<void> check(const NamesInput& input) const {
    const bool has_label = has(ColumnRole::kLabel) || has(ColumnRole::kKey);
    if (!has(ColumnRole::kName) && !has_label) {
      return input.refuse("line 1: no column has labels or names; call one \"label\" and one \"name\"");
    }
    const int channels = static_cast<int>(has(ColumnRole::kRed)) + static_cast<int>(has(ColumnRole::kGreen)) +
                         static_cast<int>(has(ColumnRole::kBlue));
    if (channels != 0 && channels != 3) {
      return input.refuse(
          fmt::format("line 1: has {} of the three colour columns red, green and blue; add {}", channels,
                      channels == 2 ? "the third" : "the others"));
    }
    const std::size_t red = find_column(columns_, ColumnRole::kRed);
    if (!has_label && red != std::string::npos && equal_ignoring_case(names_[red], "Color_R")) {
      return input.refuse("line 1: the column LabelValue is missing; add it");  // a table of 3D Slicer
    }
    return {};
  }

  void note_ignored_columns() const {
    for (std::size_t n = 0; n < columns_.size(); ++n) {
      if (columns_[n].role == ColumnRole::kUnknown && !names_[n].empty()) into_.add_ignored_column(names_[n]);
    }
  }

  [[nodiscard]] bool has(ColumnRole role) const { return find_column(columns_, role) != std::string::npos; }

  TableEntry read(const Table::Row& row) const {
    TableEntry entry;
    entry.name.line = row.line;
    entry.name.name = field(row, ColumnRole::kName);
    entry.key = field(row, ColumnRole::kKey);
    entry.label = field(row, has(ColumnRole::kLabel) ? ColumnRole::kLabel : ColumnRole::kKey);
    entry.name.key = entry.key;
    if (entry.key.empty()) entry.key = entry.label;
    entry.parent = field(row, ColumnRole::kParent);
    if (to_lower(entry.parent) == "null") entry.parent.clear();
    entry.path = field(row, ColumnRole::kPath);
    read_color(row, entry);
    read_terms(row, entry);
    return entry;
  }

 private:
  /// A field; "" where the table has none, or one that stands for none.
  static std::string field(const Table::Row& row, std::size_t column) {
    if (column >= row.fields.size()) return {};
    const std::string lower = to_lower(row.fields[column]);
    return lower == "n/a" || lower == "nan" ? std::string() : row.fields[column];
  }
  [[nodiscard]] std::string field(const Table::Row& row, ColumnRole role) const {
    return field(row, find_column(columns_, role));
  }

  void read_color(const Table::Row& row, TableEntry& entry) const {
    std::string text = field(row, ColumnRole::kColor);
    if (text.empty() && has(ColumnRole::kRed)) {
      const std::string r = field(row, ColumnRole::kRed);
      const std::string g = field(row, ColumnRole::kGreen);
      const std::string b = field(row, ColumnRole::kBlue);
      if (r.empty() && g.empty() && b.empty()) return;
      text = fmt::format("{},{},{}", r, g, b);
    }
    if (text.empty()) return;
    entry.name.color = parse_table_color(text);
    if (!entry.name.color) into_.add_bad_color(row.line, text);
  }

  /// Adds a term once: two columns may have the same code.
  static void add_term(TableEntry& entry, const std::string& vocabulary, const std::string& value) {
    const SourceTerm term{vocabulary, value};
    std::vector<SourceTerm>& terms = entry.name.terms;
    if (std::ranges::find(terms, term) == terms.end()) terms.push_back(term);
  }

  void read_terms(const Table::Row& row, TableEntry& entry) const {
    std::map<std::string, std::string> schemes;
    for (std::size_t n = 0; n < columns_.size(); ++n) {
      const std::string value = field(row, n);
      const std::string& vocabulary = columns_[n].vocabulary;
      if (value.empty()) continue;
      switch (columns_[n].role) {
        case ColumnRole::kTerm: add_term(entry, vocabulary, value); break;
        case ColumnRole::kScheme: schemes[vocabulary] = vocabulary_of(value); break;
        case ColumnRole::kSchemeCode: {
          const std::string& scheme = schemes[vocabulary];
          if (scheme.empty()) break;
          add_term(entry, vocabulary.empty() ? scheme : fmt::format("{} {}", vocabulary, scheme), value);
          break;
        }
        case ColumnRole::kSynonym:
          for (const std::string_view synonym :
               split(value, value.find('|') != std::string::npos ? '|' : ';')) {
            if (!synonym.empty()) add_term(entry, "synonym", std::string(synonym));
          }
          break;
        default: break;
      }
    }
  }

  std::vector<Column> columns_;
  const std::vector<std::string>& names_;
  NamesCollector& into_;
};

}  // namespace

Result<TableEntries> read_entries(const Table& table, const NamesInput& input, NamesCollector& into) {
  const EntryReader reader(table, into);
  SPLATLAS_RETURN_IF_ERROR(reader.check(input));
  reader.note_ignored_columns();
  TableEntries result;
  result.has_labels = reader.has(ColumnRole::kLabel) || reader.has(ColumnRole::kKey);
  result.has_hierarchy = reader.has(ColumnRole::kParent) || reader.has(ColumnRole::kPath);
  for (const Table::Row& row : table.rows) result.entries.push_back(reader.read(row));
  for (const Table::Fault& fault : table.faults) into.add_fault(fault.line, fault.text);
  return result;
}

void add_entries(TableEntries entries, NamesCollector& into) {
  if (entries.has_hierarchy) into.set_hierarchy(hierarchy_of(entries));
  for (TableEntry& entry : entries.entries) {
    const bool is_group = entry.label.empty() && entries.has_hierarchy;
    if (!entries.has_labels) {
      into.add(std::move(entry.name));
    } else if (!is_group) {
      into.add(entry.label, std::move(entry.name));
    }
  }
}

}  // namespace splatlas

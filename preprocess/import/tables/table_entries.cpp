#include <algorithm>
#include <map>
#include <unordered_map>

#include <fmt/format.h>

#include "format/result_macros.h"
#include "format/text/ascii_text.h"
#include "preprocess/import/tables/table.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

/// Ends each name of a path that stands in columns of levels; no valid name holds it.
constexpr char kLevelEnd = '\x1f';

/// Reads rows by the roles of their columns.
class EntryReader {
 public:
  EntryReader(const Table& table, NamesCollector& into)
      : columns_(columns_of(table)), names_(table.columns), into_(into) {
    std::vector<std::string> colors;
    for (const Table::Row& row : table.rows) colors.push_back(color_text(row));
    color_scale_ = scale_of_colors(colors);
  }

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

  [[nodiscard]] bool has(ColumnRole role) const { return has_column(columns_, role); }

  TableEntry read(const Table::Row& row) const {
    TableEntry entry;
    entry.name.line = row.line;
    entry.name.name = field(row, ColumnRole::kName);
    entry.key = field(row, ColumnRole::kKey);
    entry.label = field(row, has(ColumnRole::kLabel) ? ColumnRole::kLabel : ColumnRole::kKey);
    entry.name.key = entry.key;
    if (entry.key.empty()) entry.key = entry.label;
    entry.parent = field(row, ColumnRole::kParent);
    for (const char* none : {"null", "none", "na", "-"}) {
      if (to_lower(entry.parent) == none) entry.parent.clear();
    }
    entry.path = field(row, ColumnRole::kPath);
    for (std::size_t n = 0; n < columns_.size(); ++n) {
      if (columns_[n].role == ColumnRole::kLevel && !field(row, n).empty())
        entry.path += field(row, n) + kLevelEnd;
    }
    entry.name.code = parse_integer(field(row, ColumnRole::kCode));
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

  /// The colour, or its three channels; "" without one.
  [[nodiscard]] std::string color_text(const Table::Row& row) const {
    std::string text = field(row, ColumnRole::kColor);
    if (!text.empty() || !has(ColumnRole::kRed)) return text;
    text = fmt::format("{},{},{}", field(row, ColumnRole::kRed), field(row, ColumnRole::kGreen),
                       field(row, ColumnRole::kBlue));
    return text == ",," ? std::string() : text;
  }

  void read_color(const Table::Row& row, TableEntry& entry) const {
    const std::string text = color_text(row);
    if (text.empty()) return;
    entry.name.color = parse_table_color(text, color_scale_);
    if (!entry.name.color) into_.add_note("bad-colors", row.line, text);
  }

  /// Adds a term once: two columns may have the same code.
  static void add_term(TableEntry& entry, const std::string& vocabulary, const std::string& value) {
    const Term term{vocabulary, value};
    std::vector<Term>& terms = entry.name.terms;
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
  double color_scale_ = 1;
};

/// An id as a key: "9003.0" is 9003.
std::string key_of_id(std::string_view id) {
  const auto label = parse_label(trimmed(id));
  return "id:" + (label ? fmt::format("{}", *label) : name_key(id));
}

/// The parts of "/997/8/", "[997, 8]", "997;8", "10-1", "Brain/Left", "Brain > Left", "Brain -> Left" or
/// "Brain::Left".
std::vector<std::string> parts_of(std::string_view path) {
  path = trimmed(path);
  if (path.starts_with('[') && path.ends_with(']')) path = path.substr(1, path.size() - 2);
  const bool are_ids = path.find_first_not_of("0123456789/|;,.- >") == std::string_view::npos;
  const bool has_slash = path.find('/') != std::string_view::npos;
  const std::size_t level = path.find(kLevelEnd);
  const std::size_t other = level != std::string_view::npos ? level
                                                            : path.find_first_of(are_ids     ? "/|;,.- >"
                                                                                 : has_slash ? ">"
                                                                                             : ">|;\\");
  const bool is_double = path.find("::") != std::string_view::npos;
  const char separator = other != std::string_view::npos ? path[other] : is_double ? ':' : '/';
  std::vector<std::string> parts;
  for (std::string_view part : split(path, separator)) {
    if (separator == '>' && part.ends_with('-')) part = trimmed(part.substr(0, part.size() - 1));
    if (!part.empty()) parts.emplace_back(part);
  }
  return parts;
}

bool are_ids(std::span<const std::string> parts) {
  return std::ranges::all_of(parts, [](const std::string& part) { return parse_integer(part).has_value(); });
}

class HierarchyMaker {
 public:
  explicit HierarchyMaker(const TableEntries& entries) : entries_(entries.entries) {}

  std::vector<TreeLine> make() {
    for (std::size_t n = 0; n < entries_.size(); ++n) keys_.push_back(claim_key(n));
    for (std::size_t n = 0; n < entries_.size(); ++n) register_path(n);
    for (std::size_t n = 0; n < entries_.size(); ++n) add(n);
    return std::move(lines_);
  }

 private:
  std::string claim_key(std::size_t n) {
    const TableEntry& entry = entries_[n];
    std::string key = entry.key.empty() ? "" : key_of_id(entry.key);
    if (key.empty() || !entry_of_key_.emplace(key, n).second) {
      key = fmt::format("row:{}", n);
      entry_of_key_.emplace(key, n);
    }
    key_of_name_.emplace(name_key(entry.name.name), key);
    for (const Term& term : entry.name.terms) {
      if (term.vocabulary == "abbreviation")
        key_of_name_.emplace("abbreviation:" + name_key(term.value), key);
    }
    return key;
  }

  /// Names of the path to an entry, itself included. Empty for paths of ids.
  [[nodiscard]] std::vector<std::string> names_of_path(std::size_t n) const {
    const TableEntry& entry = entries_[n];
    std::vector<std::string> parts = parts_of(entry.path);
    parts.resize(std::min(parts.size(), kMaxGraphDepth + 2));  // deeper paths are refused later
    if (are_ids(parts) || (!entry.key.empty() && key_of_id(parts.back()) == key_of_id(entry.key))) return {};
    if (name_key(parts.back()) != name_key(entry.name.name)) parts.push_back(entry.name.name);
    return parts;
  }

  static std::string path_key(std::span<const std::string> parts) {
    std::string key = "path:";
    for (const std::string& part : parts) key += name_key(part) + "/";
    return key;
  }

  void register_path(std::size_t n) {
    const std::vector<std::string> parts = names_of_path(n);
    if (!parts.empty()) key_of_path_.emplace(path_key(parts), keys_[n]);
  }

  void add(std::size_t n) {
    const TableEntry& entry = entries_[n];
    TreeNode node{keys_[n], entry.name.name, parse_label(entry.label), {}};
    if (node.label == 0) return;  // background
    for (std::string& parent : parents_of(n)) {
      if (!parent.empty() && parent != node.key) node.parents.push_back(std::move(parent));
    }
    if (node.name.empty() && node.label) node.name = fmt::format("Label {}", *node.label);
    TreeLine line;
    line.number = entry.name.line;
    if (entry.name.color) line.color = ColorRange{*entry.name.color, *entry.name.color};
    line.node = std::move(node);
    lines_.push_back(std::move(line));
  }

  /// The keys of the parents, "" for none. A list of ids ("10;11") has several. Of a path of ids it is the
  /// last region listed; ids behind it have none, and build_graph() counts them.
  std::vector<std::string> parents_of(std::size_t n) {
    const TableEntry& entry = entries_[n];
    const std::size_t line = entry.name.line;
    std::vector<std::string> parents;
    if (!entry.parent.empty()) {
      const std::vector<std::string> parts = parts_of(entry.parent);
      const bool is_known =
          entry_of_key_.contains(key_of_id(entry.parent)) || key_of_name_.contains(name_key(entry.parent));
      if (parts.size() < 2 || is_known) return {find_parent(entry.parent, line)};
      if (!are_ids(parts) && entry.parent.find_first_of(";|") == std::string::npos)
        return {find_group(parts, line)};
      for (const std::string& part : parts) parents.push_back(find_parent(part, line));
      return parents;
    }
    const std::vector<std::string> names = names_of_path(n);
    if (!names.empty()) return {find_group(std::span(names).first(names.size() - 1), line)};
    std::vector<std::string> ids = parts_of(entry.path);
    if (!ids.empty() && !entry.key.empty() && key_of_id(ids.back()) == key_of_id(entry.key)) ids.pop_back();
    for (; !ids.empty(); ids.pop_back()) {
      parents.push_back(key_of_id(ids.back()));
      if (entry_of_key_.contains(parents.back())) break;
    }
    return parents;
  }

  std::string find_parent(const std::string& text, std::size_t line) {
    if (std::string key = key_of_id(text); entry_of_key_.contains(key)) return key;
    for (const std::string& key : {"abbreviation:" + name_key(text), name_key(text)}) {
      if (const auto found = key_of_name_.find(key); found != key_of_name_.end()) return found->second;
    }
    // An id that no entry has: build_graph() counts it.
    return parse_integer(text) ? key_of_id(text) : find_group({&text, 1}, line);
  }

  /// The group of a path of names, made at its first use.
  std::string find_group(std::span<const std::string> parts, std::size_t line) {
    std::string parent;
    for (std::size_t n = 1; n <= parts.size() && key_of_path_.size() <= kMaxStructures; ++n) {
      const std::string path = path_key(parts.first(n));
      const auto [found, is_new] = key_of_path_.emplace(path, path);
      if (is_new) {
        TreeLine& group = lines_.emplace_back();
        group.number = line;
        group.node = TreeNode{path, parts[n - 1], std::nullopt, {}};
        if (!parent.empty()) group.node->parents.push_back(parent);
      }
      parent = found->second;
    }
    return parent;
  }

  std::span<const TableEntry> entries_;
  std::vector<std::string> keys_;  // [entry]
  std::unordered_map<std::string, std::size_t> entry_of_key_;
  std::unordered_map<std::string, std::string> key_of_name_;
  std::unordered_map<std::string, std::string> key_of_path_;
  std::vector<TreeLine> lines_;
};

}  // namespace

Result<TableEntries> read_entries(const Table& table, const NamesInput& input, NamesCollector& into) {
  const EntryReader reader(table, into);
  SPLATLAS_RETURN_IF_ERROR(reader.check(input));
  reader.note_ignored_columns();
  TableEntries result;
  result.has_labels = reader.has(ColumnRole::kLabel) || reader.has(ColumnRole::kKey);
  result.has_hierarchy =
      std::ranges::any_of(std::array{ColumnRole::kParent, ColumnRole::kPath, ColumnRole::kLevel},
                          [&](ColumnRole role) { return reader.has(role); });
  for (const Table::Row& row : table.rows) result.entries.push_back(reader.read(row));
  for (const Table::Fault& fault : table.faults) into.add_fault(fault.line, fault.text);
  return result;
}

Result<void> add_table(const Table& table, const NamesInput& input, NamesCollector& into) {
  SPLATLAS_ASSIGN_OR_RETURN(TableEntries entries, read_entries(table, input, into));
  if (entries.has_hierarchy) into.set_hierarchy(hierarchy_of(entries));
  if (!entries.has_labels) into.set_columns(table.columns);
  for (TableEntry& entry : entries.entries) {
    const bool is_group = entry.label.empty() && entries.has_hierarchy;
    if (!entries.has_labels) {
      into.add(std::move(entry.name));
    } else if (!is_group) {
      into.add(entry.label, std::move(entry.name));
    }
  }
  return {};
}

std::vector<TreeLine> hierarchy_of(const TableEntries& entries) {
  return HierarchyMaker(entries).make();
}

}  // namespace splatlas

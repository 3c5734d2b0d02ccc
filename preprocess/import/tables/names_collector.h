// Rows of a names file while it is read, and the readers of its dialects.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "format/result.h"
#include "preprocess/import/notes.h"
#include "preprocess/import/tables/names_table.h"

namespace splatlas {

/// Largest label of a label map.
inline constexpr std::int64_t kMaxLabel = 0xffffffff;

/// A names file: its text, and how to call it.
struct NamesInput {
  std::filesystem::path path;
  std::string text;
  std::string title;  ///< of the dialect, for messages

  /// "entry" for JSON and XML, "line" for other texts; messages number rows by it.
  [[nodiscard]] const char* unit() const {
    const std::size_t first = std::min(text.find_first_not_of(" \t\r\n"), text.size());
    return text.substr(first, 1).find_first_of("[{<") == 0 ? "entry" : "line";
  }

  /// "FILE: is read as TITLE: ..." as the error of a reader.
  [[nodiscard]] tl::unexpected<Error> refuse(const std::string& fault) const;
};

/// Keeps usable rows and counts the others as notes.
class NamesCollector {
 public:
  NamesCollector(const NamesInput& input, Notes& notes) : input_(input), notes_(notes) {}

  /// Adds a row. Skips label 0; drops faulty and repeated labels, and names that check_structure_name()
  /// refuses. A row without a label needs a name.
  void add(LabelName name);
  /// Parses the label of a row and adds it; a text that is no label is a fault.
  void add(std::string_view label, LabelName name);
  /// A row that cannot be used.
  void add_fault(std::size_t line, const std::string& fault);
  /// A value to note, such as a colour that cannot be read.
  void add_note(std::string_view kind, std::size_t line, std::string_view value);
  /// A column that no reader knows.
  void add_ignored_column(std::string_view name);

  void set_columns(std::vector<std::string> columns) { table_.columns = std::move(columns); }
  void set_hierarchy(std::vector<TreeLine> lines) { table_.hierarchy = std::move(lines); }

  /// The table. kFailed, with the first fault, if no row was usable.
  [[nodiscard]] Result<NamesTable> finish();

 private:
  [[nodiscard]] std::string place(std::size_t line) const;

  const NamesInput& input_;
  Notes& notes_;
  NamesTable table_;
  std::string first_fault_;
  std::unordered_map<std::int64_t, std::size_t> line_of_label_;
  std::unordered_set<std::string> unlabelled_;  // by name_key
};

/// A whole label from 0 to 2^32 - 1; "17.0" counts. Nullopt for other text.
[[nodiscard]] std::optional<std::int64_t> parse_label(std::string_view text);

/// Bytes of a file that Dialect::recognise sees.
inline constexpr std::size_t kNamesHeadBytes = 64 << 10;

/// A dialect. The order of the table in read_names.cpp decides between several that recognise a file.
struct Dialect {
  NamesFormatInfo info;
  /// True if the first bytes of a file are of this dialect.
  bool (*recognise)(std::string_view head);
  /// Adds the rows. An error means that nothing of the file is usable.
  Result<void> (*read)(const NamesInput& input, NamesCollector& into);
};

// Lists (read_lists.cpp).
extern const Dialect kItkSnapNames, kFslEyesNames, kCtblNames, kFreeSurferNames, kMricronNames;
// Tables with columns, and FSL's XML (read_columns.cpp).
extern const Dialect kBidsNames, kCsvNames, kFslNames;
// JSON (read_json.cpp).
extern const Dialect kNiivueNames, kAllenNames, kBrainGlobeNames, kOpenAnatomyNames, kDcmqiNames, kJsonNames;

/// The hierarchy of a JSON file of names.
[[nodiscard]] Result<std::vector<TreeLine>> read_json_tree(const NamesInput& input, NamesCollector& into);

}  // namespace splatlas

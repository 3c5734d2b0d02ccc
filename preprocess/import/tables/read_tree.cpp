#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "format/result_macros.h"
#include "preprocess/import/tables/names_collector.h"
#include "preprocess/import/tables/names_table.h"
#include "preprocess/import/tables/table.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

// Tree files: one path per line (see build --help).

/// Parses "#rrggbb" or "#rrggbb-#rrggbb".
Result<ColorRange> parse_color_range(std::string_view text) {
  const std::size_t dash = text.find('-');
  SPLATLAS_ASSIGN_OR_RETURN(const Rgb first, parse_color(text.substr(0, dash)));
  if (dash == std::string_view::npos) return ColorRange{first, first};
  SPLATLAS_ASSIGN_OR_RETURN(const Rgb last, parse_color(text.substr(dash + 1)));
  return ColorRange{first, last};
}

Result<TreeLine> parse_line(std::string_view text) {
  TreeLine line;
  constexpr std::string_view kColor = " color=";
  if (const std::size_t at = text.rfind(kColor); at != std::string_view::npos) {
    SPLATLAS_ASSIGN_OR_RETURN(line.color, parse_color_range(trimmed(text.substr(at + kColor.size()))));
    text = trimmed(text.substr(0, at));
  }
  const std::vector<std::string_view> parts = split(text, '/');
  for (std::size_t n = 0; n < parts.size(); ++n) {
    const bool last = n + 1 == parts.size();
    if (parts[n].empty() && !(last && n > 0)) return fail(ErrorCode::kUsage, "a part of the path is empty");
    if (!last && parts[n].find('*') != std::string_view::npos) {
      return fail(ErrorCode::kUsage, "'{}': only the last part may be a pattern", parts[n]);
    }
    if (last) {
      line.member = std::string(parts[n]);
    } else {
      if (const auto fit = check_structure_name(parts[n]); !fit)
        return fail(ErrorCode::kUsage, fit.error().message);
      line.groups.emplace_back(parts[n]);
    }
  }
  return line;
}

Result<std::vector<TreeLine>> read_path_tree(const NamesInput& input, NamesCollector& /*into*/) {
  std::vector<TreeLine> result;
  for (const TextLine& text : lines_of(input.text)) {
    Result<TreeLine> line = parse_line(text.text);
    if (!line) return bad_file(input.path, "line {}: {}", text.number, line.error().message);
    line->number = text.number;
    result.push_back(std::move(*line));
  }
  return result;
}

/// Tables with a column of names or ids, unlike lines of paths.
bool recognise_table_tree(std::string_view head) {
  const auto separator = find_separator(head);
  if (!separator) return false;
  const std::vector<std::string> columns = parse_table(lines_of(head).front().text, *separator).columns;
  return columns.size() > 1 && std::ranges::any_of(columns, [](const std::string& name) {
           const ColumnRole role = column_of(name).role;
           return role == ColumnRole::kName || role == ColumnRole::kKey || role == ColumnRole::kLabel;
         });
}

Result<std::vector<TreeLine>> read_table_tree(const NamesInput& input, NamesCollector& into) {
  const auto separator = find_separator(input.text);
  const Table table = parse_table(input.text, separator.value_or(','));
  SPLATLAS_ASSIGN_OR_RETURN(const TableEntries entries, read_entries(table, input, into));
  if (!entries.has_hierarchy) {
    return input.refuse(
        fmt::format("a tree needs a column \"parent\" or \"path\", or columns \"level1\", \"level2\" "
                    "and so on; the columns are {}",
                    fmt::join(table.columns, ", ")));
  }
  if (entries.entries.empty()) return input.refuse("has no row below its header; add some");
  return hierarchy_of(entries);
}

struct TreeDialect {
  const char* title;
  bool (*recognise)(std::string_view head);
  Result<std::vector<TreeLine>> (*read)(const NamesInput& input, NamesCollector& into);
};

/// Detection takes the first that fits; the last fits all.
constexpr TreeDialect kTreeDialects[] = {
    {"JSON tree", [](std::string_view head) { return kJsonNames.recognise(head); }, read_json_tree},
    {"table of parents or paths", recognise_table_tree, read_table_tree},
    {"tree file", [](std::string_view) { return true; }, read_path_tree},
};

}  // namespace

Result<std::vector<TreeLine>> read_tree(const std::filesystem::path& path, Notes& notes) {
  SPLATLAS_ASSIGN_OR_RETURN(std::string text, read_text(path));
  const std::string_view head = std::string_view(text).substr(0, kNamesHeadBytes);
  const auto* dialect =
      std::ranges::find_if(kTreeDialects, [&](const TreeDialect& d) { return d.recognise(head); });
  const NamesInput input{path, std::move(text), dialect->title};
  NamesCollector faults(input, notes);
  auto lines = dialect->read(input, faults);
  if (lines && dialect->read != read_path_tree)
    notes.add("tree-format", fmt::format("{} is read as {}", path.filename().string(), dialect->title));
  return lines;
}

}  // namespace splatlas

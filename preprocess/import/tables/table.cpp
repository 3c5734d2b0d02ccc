#include "preprocess/import/tables/table.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

/// Splits a text into records of fields.
class RecordReader {
 public:
  RecordReader(std::string_view text, char separator) : text_(text), separator_(separator) {}

  /// The next record that is neither blank nor a comment. Its fields are empty if a quote has no end.
  std::optional<Table::Row> next() {
    while (at_ < text_.size()) {
      const std::string_view line = rest_of_line();
      if (!trimmed(line).empty() && !is_comment(line)) {
        has_header_ = true;
        return read_record();
      }
      at_ += line.size();
      skip_line_end();
    }
    return std::nullopt;
  }

 private:
  /// Below the header, a line with a separator is a row: its first field may be "#ff0000".
  [[nodiscard]] bool is_comment(std::string_view line) const {
    if (trimmed(line).front() != '#') return false;
    return !has_header_ || line.find(separator_) == std::string_view::npos;
  }

  [[nodiscard]] std::string_view rest_of_line() const {
    return text_.substr(at_, std::min(text_.find_first_of("\r\n", at_), text_.size()) - at_);
  }

  void skip_line_end() {
    if (at_ >= text_.size()) return;
    at_ += text_.substr(at_).starts_with("\r\n") ? 2 : 1;
    ++line_;
  }

  Table::Row read_record() {
    Table::Row row{line_, {}};
    const std::size_t start = at_;
    while (true) {
      const auto field = read_field();
      if (!field) {  // resume behind the line of the open quote
        at_ = start;
        line_ = row.line;
        at_ += rest_of_line().size();
        row.fields.clear();
        break;
      }
      row.fields.push_back(*field);
      if (at_ >= text_.size() || text_[at_] != separator_) break;
      ++at_;
    }
    skip_line_end();
    return row;
  }

  /// A field up to its separator or line end. Nullopt for a quote without an end.
  std::optional<std::string> read_field() {
    while (at_ < text_.size() && text_[at_] == ' ' && separator_ != ' ') ++at_;
    std::string field;
    if (at_ < text_.size() && text_[at_] == '"') {
      ++at_;
      for (;; ++at_) {
        if (at_ >= text_.size()) return std::nullopt;
        if (text_[at_] == '"') {
          if (!text_.substr(at_).starts_with("\"\"")) break;
          ++at_;
        }
        if (text_[at_] == '\n') ++line_;
        field += text_[at_];
      }
      ++at_;
    }
    const std::array<char, 4> ends{separator_, '\r', '\n', '\0'};
    const std::size_t end = std::min(text_.find_first_of(ends.data(), at_), text_.size());
    field += text_.substr(at_, end - at_);
    at_ = end;
    return std::string(trimmed(field));
  }

  std::string_view text_;
  char separator_;
  std::size_t at_ = 0;
  std::size_t line_ = 1;
  bool has_header_ = false;
};

}  // namespace

std::optional<char> find_separator(std::string_view text) {
  const std::vector<TextLine> lines = lines_of(text.substr(0, 64 << 10));
  if (lines.empty()) return std::nullopt;
  std::array<std::pair<char, int>, 3> counts{{{'\t', 0}, {';', 0}, {',', 0}}};
  bool is_quoted = false;
  for (const char c : lines.front().text) {
    if (c == '"') is_quoted = !is_quoted;
    for (auto& [separator, count] : counts) count += c == separator && !is_quoted ? 1 : 0;
  }
  const auto* best = std::ranges::max_element(counts, {}, &std::pair<char, int>::second);
  return best->second > 0 ? std::optional(best->first) : std::nullopt;
}

Table parse_table(std::string_view text, char separator) {
  Table table;
  RecordReader reader(text, separator);
  while (auto row = reader.next()) {
    if (row->fields.empty()) {
      table.faults.push_back({row->line, "a quote has no end; add it"});
      continue;
    }
    if (table.columns.empty()) {
      table.columns = std::move(row->fields);
      continue;
    }
    while (row->fields.size() > table.columns.size() && row->fields.back().empty()) row->fields.pop_back();
    if (row->fields.size() > table.columns.size()) {
      table.faults.push_back(
          {row->line,
           fmt::format("has {} fields, the header {}; put a field with '{}' into "
                       "double quotes",
                       row->fields.size(), table.columns.size(), separator == '\t' ? ' ' : separator)});
      continue;
    }
    table.rows.push_back(std::move(*row));
  }
  return table;
}

}  // namespace splatlas

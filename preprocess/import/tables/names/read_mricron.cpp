// Lists of MRIcron, AAL and most others: label name [code].
#include <algorithm>

#include <fmt/format.h>

#include "format/text/ascii_text.h"
#include "preprocess/import/tables/names/dialects.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

/// Words of a line. Text in double quotes is one word, without the quotes.
struct Words {
  std::vector<std::string_view> all;
  bool last_is_quoted = false;
  std::string_view unclosed;  ///< the text from a quote without an end
};

Words split_words(std::string_view line) {
  Words words;
  for (line = trimmed(line); !line.empty(); line = trimmed(line)) {
    const bool opens = line.front() == '"';
    const bool is_quoted = opens && line.find('"', 1) != std::string_view::npos;
    if (opens && !is_quoted) words.unclosed = line;
    const std::size_t end = is_quoted ? line.find('"', 1) : std::min(line.find_first_of(" \t"), line.size());
    words.all.push_back(is_quoted ? line.substr(1, end - 1) : line.substr(0, end));
    words.last_is_quoted = is_quoted;
    line.remove_prefix(is_quoted ? end + 1 : end);
  }
  return words;
}

/// Parses what follows the label: a number after the name is the code.
LabelName parse_name(std::string_view rest, const Words& words) {
  LabelName result;
  const std::optional<std::int64_t> number = parse_integer(words.all.back());
  if (words.all.size() > 2 && !words.last_is_quoted && number) {
    result.code = number;
    rest = trimmed(rest.substr(0, rest.find_last_of(" \t")));
  }
  if (rest.size() > 1 && rest.front() == '"' && rest.back() == '"') rest = rest.substr(1, rest.size() - 2);
  result.name = std::string(trimmed(rest));
  return result;
}

}  // namespace

bool recognise_mricron(std::string_view head, std::string_view /*file*/) {
  const std::vector<TextLine> lines = lines_of(head);
  return !lines.empty() && parse_integer(split_blanks(lines.front().text).front());
}

Result<void> read_mricron(const NamesInput& input, NamesCollector& into) {
  for (const TextLine& line : lines_of(input.text)) {
    const std::string_view text = line.text;
    const std::string_view label = split_blanks(text).front();
    const Words words = split_words(text);
    if (!words.unclosed.empty() && parse_label(label) != 0) {
      into.add_fault(line.number, fmt::format("{} has no closing quote; add it", in_quotes(words.unclosed)));
      continue;
    }
    LabelName name;
    if (words.all.size() > 1) name = parse_name(trimmed(text.substr(label.size())), words);
    name.line = line.number;
    into.add(label, std::move(name));
  }
  return {};
}

}  // namespace splatlas

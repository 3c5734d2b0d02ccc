#include "preprocess/import/tables/read_names.h"

#include <algorithm>
#include <fstream>
#include <map>

#include <fmt/format.h>

#include "format/system/result_macros.h"
#include "preprocess/import/import_error.h"
#include "preprocess/import/tables/structure_name.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

constexpr std::int64_t kMaxLabel = 0xffffffff;

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

/// True for the columns of ITK-SNAP: label R G B A visible mesh "name".
bool is_itk_snap(const Words& words) {
  return words.all.size() == 8 && words.last_is_quoted &&
         std::all_of(words.all.begin(), words.all.end() - 1,
                     [](std::string_view word) { return parse_number(word).has_value(); });
}

Result<LabelName> parse_itk_snap(const Words& words) {
  std::array<std::uint8_t, 3> rgb{};
  for (std::size_t n = 0; n < 3; ++n) {
    const auto value = parse_integer(words.all[n + 1]);
    if (!value || *value < 0 || *value > 255) {
      return fail(ErrorCode::kFailed, "the colour value {} must be a whole number from 0 to 255",
                  words.all[n + 1]);
    }
    rgb[n] = static_cast<std::uint8_t>(*value);
  }
  LabelName result;
  result.name = std::string(words.all.back());
  result.color = Rgb{rgb[0], rgb[1], rgb[2]};
  return result;
}

/// Parses `label name [code]`: a number after the name is the code.
LabelName parse_plain(std::string_view line, const Words& words) {
  LabelName result;
  std::string_view rest = trimmed(line.substr(line.find_first_of(" \t")));
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

Result<std::vector<LabelName>> read_names(const std::filesystem::path& path) {
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<TextLine> lines, read_text_lines(path));
  std::vector<LabelName> names;
  std::map<std::int64_t, std::size_t> line_of_label;
  std::map<std::string, std::size_t> line_of_name;
  for (const TextLine& line : lines) {
    const auto refuse = [&]<typename... Args>(fmt::format_string<Args...> what, Args&&... args) {
      return bad_file(path, "line {}: {}", line.number, fmt::format(what, std::forward<Args>(args)...));
    };
    const std::string_view first_word = split_blanks(line.text).front();
    const auto label = parse_integer(first_word);
    if (!label || *label < 0 || *label > kMaxLabel) {
      return refuse("'{}' is no label (0 to {}); a line is: label name [code]", first_word, kMaxLabel);
    }
    const Words words = split_words(line.text);
    if (*label == 0) continue;
    if (words.all.size() < 2) return refuse("label {} has no name", *label);
    if (!words.unclosed.empty()) return refuse("{} has no closing quote; add it", words.unclosed);
    Result<LabelName> parsed = is_itk_snap(words) ? parse_itk_snap(words) : parse_plain(line.text, words);
    if (!parsed) return refuse("{}", parsed.error().message);
    LabelName& name = *parsed;
    if (name.name.empty()) return refuse("label {} has no name", *label);
    if (const auto fit = check_structure_name(name.name); !fit) return refuse("{}", fit.error().message);
    if (const auto [first, is_new] = line_of_name.emplace(name_key(name.name), line.number); !is_new) {
      return refuse("the name '{}' is taken already, in line {}", name.name, first->second);
    }
    if (const auto [first, is_new] = line_of_label.emplace(*label, line.number); !is_new) {
      return refuse("label {} has a name already, in line {}", *label, first->second);
    }
    name.label = *label;
    name.line = line.number;
    names.push_back(std::move(name));
  }
  if (names.empty()) return bad_file(path, "names no label");
  return names;
}

Result<std::array<Rgb, 256>> read_color_table(const std::filesystem::path& path) {
  SPLATLAS_RETURN_IF_ERROR(check_regular_file(path));
  std::ifstream file(path, std::ios::binary);
  std::array<char, 769> bytes{};
  file.read(bytes.data(), bytes.size());
  if (file.gcount() != 768) {
    return bad_file(path, "is no colour table: it must be 768 bytes long (256 reds, greens, blues)");
  }
  std::array<Rgb, 256> colors;
  for (std::size_t n = 0; n < 256; ++n) {
    colors[n] = {static_cast<std::uint8_t>(bytes[n]), static_cast<std::uint8_t>(bytes[256 + n]),
                 static_cast<std::uint8_t>(bytes[512 + n])};
  }
  return colors;
}

}  // namespace splatlas

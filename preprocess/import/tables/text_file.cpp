#include "preprocess/import/tables/text_file.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>

#include <fmt/ranges.h>
#include <nettle/sha2.h>
#include <utf8cpp/utf8.h>

#include "format/result_macros.h"

namespace splatlas {
namespace {

/// Lines of a text with any line endings.
class LineReader {
 public:
  explicit LineReader(std::string_view text) : text_(text) {}

  std::optional<std::string_view> next() {
    if (start_ >= text_.size()) return std::nullopt;
    const std::size_t end = std::min(text_.find_first_of("\r\n", start_), text_.size());
    const std::string_view line = text_.substr(start_, end - start_);
    start_ = end + (text_.substr(end).starts_with("\r\n") ? 2 : 1);
    return line;
  }

 private:
  std::string_view text_;
  std::size_t start_ = 0;
};

std::string_view without_plus(std::string_view text) {
  return text.starts_with('+') ? text.substr(1) : text;
}

/// Turns XML that declares ISO-8859-1 into UTF-8, which it may be all the same.
void decode_latin_1(std::string& text) {
  constexpr std::string_view kLatin1 = "iso-8859-1";
  const std::size_t at =
      text.starts_with("<?xml") ? to_lower(text.substr(0, text.find("?>"))).find(kLatin1) : std::string::npos;
  if (at == std::string::npos) return;
  text.replace(at, kLatin1.size(), "UTF-8");
  if (utf8::is_valid(text.begin(), text.end())) return;
  for (const char c : std::exchange(text, {}))
    utf8::append(static_cast<unsigned char>(c), std::back_inserter(text));
}

/// A name and a colour a line.
constexpr std::string_view kCssColors =
#include "preprocess/import/tables/css_colors.txt"
    ;

std::optional<Rgb> parse_hex(std::string_view digits) {
  if (digits.size() == 4) digits = digits.substr(0, 3);  // with alpha
  if (digits.size() == 8) digits = digits.substr(0, 6);
  const auto color = parse_color(fmt::format("#{}", digits));
  return color ? std::optional(*color) : std::nullopt;
}

/// Three or four numbers with commas or blanks between them, perhaps in brackets; the fourth is alpha.
std::optional<std::array<double, 3>> parse_numbers(std::string_view text) {
  const std::size_t open = text.find_first_of("([");
  if ((open == 0 || text.starts_with("rgb")) && open != std::string_view::npos &&
      (text.ends_with(')') || text.ends_with(']')))
    text = text.substr(open + 1, text.size() - open - 2);
  const std::vector<std::string_view> parts =
      text.find(',') != std::string_view::npos ? split(text, ',') : split_blanks(text);
  if (parts.size() != 3 && parts.size() != 4) return std::nullopt;
  std::array<double, 3> numbers{};
  for (std::size_t n = 0; n < 3; ++n) {
    const auto number = parse_number(parts[n]);
    if (!number) return std::nullopt;
    numbers[n] = *number;
  }
  return numbers;
}

}  // namespace

std::vector<std::filesystem::path> regular_files_of(const std::filesystem::path& path,
                                                    std::error_code& error) {
  std::error_code unreadable;  // or a link to nothing
  if (!std::filesystem::is_directory(path, unreadable)) return {path};
  std::vector<std::filesystem::path> files;
  for (std::filesystem::recursive_directory_iterator entry(path, error), end; !error && entry != end;
       entry.increment(error)) {
    if (entry->is_regular_file(unreadable)) files.push_back(entry->path());
  }
  std::ranges::sort(files);
  return files;
}

std::vector<std::filesystem::path> visible_files(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code error;
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    std::error_code unreadable;
    if (!entry->path().filename().string().starts_with('.') && entry->is_regular_file(unreadable))
      files.push_back(entry->path());
  }
  std::ranges::sort(files);
  return files;
}

Result<void> check_regular_file(const std::filesystem::path& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::not_found) return bad_file(path, "no such file");
  if (status.type() == std::filesystem::file_type::directory) {
    return bad_file(path, "is a folder; a file is needed here");
  }
  if (status.type() == std::filesystem::file_type::none) {  // for example a name too long, or a loop of links
    return bad_file(path, "cannot be read: {}", error.message());
  }
  if (status.type() != std::filesystem::file_type::regular) return bad_file(path, "is not a regular file");
  if (!std::ifstream(path, std::ios::binary)) return bad_file(path, "cannot be opened for reading");
  return {};
}

Result<std::string> read_text(const std::filesystem::path& path) {
  SPLATLAS_RETURN_IF_ERROR(check_regular_file(path));
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(path, error);
  if (error || bytes > kMaxTextBytes) {
    return bad_file(path, "is larger than 16 MiB; a text file is needed here");
  }
  std::string all(bytes, '\0');
  if (!std::ifstream(path, std::ios::binary).read(all.data(), static_cast<std::streamsize>(bytes)))
    return bad_file(path, "cannot be read whole");
  if (all.starts_with("PK\3\4") || all.starts_with("\xd0\xcf\x11\xe0"))
    return bad_file(path, "is a workbook (Excel, LibreOffice) or an archive; save its table as CSV");
  if (all.starts_with("\xef\xbb\xbf")) all.erase(0, 3);  // byte order mark
  decode_latin_1(all);
  std::size_t number = 0;
  for (LineReader lines(all); const auto line = lines.next();) {
    if (++number > kMaxTextLines) return bad_file(path, "has more than {} lines", kMaxTextLines);
    if (const std::string fault = fault_of_text(*line); !fault.empty()) {
      return bad_file(path, "line {} {}; plain UTF-8 text is needed here", number, fault);
    }
  }
  return all;
}

std::vector<TextLine> lines_of(std::string_view text) {
  std::vector<TextLine> result;
  std::size_t number = 0;
  for (LineReader lines(text); const auto line = lines.next();) {
    ++number;
    const std::string_view content = trimmed(*line);
    if (!content.empty() && content.front() != '#') result.push_back({number, std::string(content)});
  }
  return result;
}

std::string first_bytes(const std::filesystem::path& path, std::size_t count) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return {};  // a pipe would wait
  std::string bytes(count, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(bytes.data(), static_cast<std::streamsize>(count));
  bytes.resize(static_cast<std::size_t>(file.gcount()));
  return bytes;
}

Result<std::string> hash_file(const std::filesystem::path& path) {
  sha256_ctx state;
  sha256_init(&state);
  std::vector<std::uint8_t> block(1 << 18);
  std::error_code error;
  for (const std::filesystem::path& name : regular_files_of(path, error)) {
    std::ifstream file(name, std::ios::binary);
    if (!file) return bad_file(name, "cannot be read");
    while (file) {
      file.read(reinterpret_cast<char*>(block.data()), static_cast<std::streamsize>(block.size()));
      sha256_update(&state, static_cast<std::size_t>(file.gcount()), block.data());
    }
    if (file.bad()) return bad_file(name, "cannot be read");
  }
  if (error) return bad_file(path, "cannot be listed ({})", error.message());
  std::array<std::uint8_t, SHA256_DIGEST_SIZE> digest{};
  sha256_digest(&state, digest.size(), digest.data());
  return fmt::format("sha256:{:02x}", fmt::join(digest, ""));
}

std::vector<std::string_view> split_blanks(std::string_view text) {
  std::vector<std::string_view> parts;
  constexpr const char* kBlanks = " \t\n";  // a stray carriage return is damage
  for (std::size_t at = text.find_first_not_of(kBlanks); at != std::string_view::npos;) {
    const std::size_t end = std::min(text.find_first_of(kBlanks, at), text.size());
    parts.push_back(text.substr(at, end - at));
    at = text.find_first_not_of(kBlanks, end);
  }
  return parts;
}

std::optional<std::int64_t> parse_integer(std::string_view text) {
  return parse_number<std::int64_t>(without_plus(text));
}
std::optional<double> parse_number(std::string_view text) {
  return parse_number<double>(without_plus(text));
}

Result<void> check_structure_name(std::string_view name) {
  const auto refuse = [&](const std::string& what) {
    return fail(ErrorCode::kFailed, "the name {} {}", in_quotes(name), what);
  };
  if (trimmed(name).empty()) return refuse("is empty");
  if (const std::string fault = fault_of_text(name); !fault.empty()) return refuse(fault);
  if (const std::size_t at = name.find_first_of("\t\n"); at != std::string_view::npos) {
    const auto before = utf8::distance(name.begin(), name.begin() + static_cast<std::ptrdiff_t>(at));
    return refuse(fmt::format("holds a {} as character {}; write a blank instead",
                              name[at] == '\t' ? "tab" : "line feed", before + 1));
  }
  if (const auto characters = static_cast<std::size_t>(utf8::distance(name.begin(), name.end()));
      characters > kMaxNameCharacters) {
    return refuse(fmt::format("has {} characters; at most {}", characters, kMaxNameCharacters));
  }
  return {};
}

std::vector<std::string> words_of(std::string_view name) {
  std::vector<std::string> words(1);
  char last = ' ';
  for (const char c : name) {
    const bool is_in_word = is_ascii_letter_or_digit(c) || static_cast<unsigned char>(c) >= 0x80;
    const bool begins = to_lower(c) != c && last >= 'a' && last <= 'z';
    if ((begins || !is_in_word) && !words.back().empty()) words.emplace_back();
    if (is_in_word) words.back() += to_lower(c);
    last = c;
  }
  if (words.back().empty()) words.pop_back();
  return words;
}

SidedName sided_name(std::string_view name) {
  std::vector<std::string> words = words_of(name);
  SidedName sided;
  for (std::size_t n = 0; n < words.size(); ++n) {
    std::string& word = words[n];
    const bool is_letter = (word == "l" || word == "r") && (n == 0 || n + 1 == words.size());
    if (!is_letter && word != "left" && word != "right" && word != "lh" && word != "rh") continue;
    if (sided.side != 0) return {};
    sided.side = word[0];
    word = "*";
  }
  sided.rest = fmt::format("{}", fmt::join(words, " "));
  return sided;
}

std::string name_key(std::string_view name) {
  return to_lower(trimmed(name));
}

std::optional<Rgb> parse_table_color(std::string_view text, double scale) {
  const std::string lower = to_lower(trimmed(text));
  if (lower.starts_with('#')) return parse_hex(std::string_view(lower).substr(1));
  const auto numbers = parse_numbers(lower);
  const bool may_be_hex =
      lower.size() == 6 || (lower.size() == 8 && !parse_number(lower));  // else a packed number
  if (!numbers) return may_be_hex ? parse_hex(lower) : std::nullopt;
  // Fractions among whole numbers
  const bool is_fraction = std::ranges::any_of(*numbers, [](double x) { return std::floor(x) != x; });
  if (scale == 1 && is_fraction && std::ranges::max(*numbers) <= 1) return std::nullopt;
  std::array<std::uint8_t, 3> rgb{};
  for (std::size_t n = 0; n < 3; ++n) {
    const double channel = std::round((*numbers)[n] * scale);
    if (!(channel >= 0 && channel <= 255)) return std::nullopt;
    rgb[n] = static_cast<std::uint8_t>(channel);
  }
  return Rgb{rgb[0], rgb[1], rgb[2]};
}

double scale_of_colors(std::span<const std::string> texts) {
  double most = 0;
  for (const std::string& text : texts) {
    if (const auto numbers = parse_numbers(to_lower(trimmed(text))))
      most = std::max(most, std::ranges::max(*numbers));
  }
  return most > 0 && most <= 1.001 ? 255 : 1;  // with rounding errors
}

std::optional<Rgb> parse_css_color(std::string_view text) {
  const std::string lower = to_lower(trimmed(text));
  const std::vector<std::string_view> words = split_blanks(kCssColors);
  const auto named = std::ranges::find(words, lower);
  return parse_table_color(named != words.end() && !lower.starts_with('#') ? named[1] : lower);
}

}  // namespace splatlas

// Text files, errors and hashes of files, parsing of numbers and colours, and structure names.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "format/content/color.h"
#include "format/result.h"
#include "format/text/ascii_text.h"

namespace splatlas {

/// Longest text file that is read, and written.
inline constexpr std::size_t kMaxTextBytes = 16u << 20, kMaxTextLines = 1'000'000;

/// A non-blank line of a text file.
struct TextLine {
  std::size_t number = 0;  ///< from 1
  std::string text;        ///< trimmed
};

/// Reads a UTF-8 file of at most 16 MiB, without its byte order mark, or XML that declares ISO-8859-1, as
/// UTF-8. kFailed unless it is plain text.
[[nodiscard]] Result<std::string> read_text(const std::filesystem::path& path);

/// The lines of a text with any line endings, without blank lines and lines that start with "#".
[[nodiscard]] std::vector<TextLine> lines_of(std::string_view text);

/// kFailed unless `path` is a regular file that can be opened for reading.
[[nodiscard]] Result<void> check_regular_file(const std::filesystem::path& path);

/// The first `count` bytes of a regular file, or all that it has; none if it cannot be read.
[[nodiscard]] std::string first_bytes(const std::filesystem::path& path, std::size_t count);

/// The regular files of a folder whose names do not begin with ".", sorted; none if it cannot be listed.
[[nodiscard]] std::vector<std::filesystem::path> visible_files(const std::filesystem::path& folder);

/// The file itself, or all regular files of a folder and its folders, sorted. Sets `error` if one of these
/// cannot be listed; the list has only some files then.
[[nodiscard]] std::vector<std::filesystem::path> regular_files_of(const std::filesystem::path& path,
                                                                  std::error_code& error);

/// "sha256:" and 64 hexadecimal digits, as printed by `sha256sum FILE`. Reads the file once; of a folder all
/// regular files, in the order of their paths, as one. kFailed if one cannot be read.
[[nodiscard]] Result<std::string> hash_file(const std::filesystem::path& path);

/// Splits at blanks, tabs and ends of lines. The parts refer to `text`.
[[nodiscard]] std::vector<std::string_view> split_blanks(std::string_view text);
std::vector<std::string_view> split_blanks(std::string&& text) = delete;
/// Parses the whole text as a number; nullopt if characters remain or the value is out of range.
[[nodiscard]] std::optional<std::int64_t> parse_integer(std::string_view text);
/// The same for floating-point numbers. Accepts "nan" and "inf".
[[nodiscard]] std::optional<double> parse_number(std::string_view text);

inline constexpr std::size_t kMaxNameCharacters = 200;

/// kFailed for empty names, more than kMaxNameCharacters characters, control characters (including tabs and
/// newlines), and invalid UTF-8. The message contains the name; callers add the location.
[[nodiscard]] Result<void> check_structure_name(std::string_view name);

/// The words of a name, in lower case: "LeftKidney" and "left_kidney" have two.
[[nodiscard]] std::vector<std::string> words_of(std::string_view name);

/// The side that a name tells, and the name with "*" in its place.
struct SidedName {
  char side = 0;  ///< 'l', 'r', or 0
  std::string rest;
};

[[nodiscard]] SidedName sided_name(std::string_view name);

/// Normalized name for comparisons: trimmed, ASCII letters in lower case.
[[nodiscard]] std::string name_key(std::string_view name);

/// kFailed: "FILE: " and the formatted text.
template <typename... Args>
[[nodiscard]] tl::unexpected<Error> bad_file(const std::filesystem::path& path,
                                             fmt::format_string<Args...> text, Args&&... args) {
  return fail(ErrorCode::kFailed, path.string() + ": " + fmt::format(text, std::forward<Args>(args)...));
}

/// Parses "#rgb", "#rrggbb", "rrggbb" and their forms with alpha, "rgb(1, 2, 3)", "rgba(1, 2, 3, 0.5)", and
/// three or four numbers such as "1,2,3" or "[1, 2, 3]", which `scale` multiplies. Rounds to whole channels
/// and ignores alpha. Nullopt for other text and for channels outside 0 to 255.
[[nodiscard]] std::optional<Rgb> parse_table_color(std::string_view text, double scale = 1);

/// The scale of the numbers of a column of colours: 255 if none is above 1 and one is above 0, else 1.
[[nodiscard]] double scale_of_colors(std::span<const std::string> texts);

/// The same, and the names of CSS level 1 and 2 ("gray", "orange").
[[nodiscard]] std::optional<Rgb> parse_css_color(std::string_view text);

}  // namespace splatlas

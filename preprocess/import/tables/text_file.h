// Small text files that people write: names, trees, headers.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "format/result.h"

namespace splatlas {

struct TextLine {
  std::size_t number = 0;  ///< from 1, as editors count
  std::string text;        ///< without blanks at both ends; never empty
};

/// The lines of a UTF-8 file (at most 16 MiB), any line ends, without blank lines and without lines that
/// start with "#". kFailed when it cannot be read or is not text.
[[nodiscard]] Result<std::vector<TextLine>> read_text_lines(const std::filesystem::path& path);

/// Refuses anything but a regular file that can be opened: folders, devices and pipes never reach a reader.
[[nodiscard]] Result<void> check_regular_file(const std::filesystem::path& path);

/// The first `count` bytes of a file, or all that it has; none if it cannot be read.
[[nodiscard]] std::string first_bytes(const std::filesystem::path& path, std::size_t count);

/// Without blanks at both ends.
[[nodiscard]] std::string_view trimmed(std::string_view text);
/// The parts between blanks; they live as long as `text` does.
[[nodiscard]] std::vector<std::string_view> split_blanks(std::string_view text);
std::vector<std::string_view> split_blanks(std::string&& text) = delete;
/// The parts between `separator`, trimmed; "a,,b" has three. They live as long as `text` does.
[[nodiscard]] std::vector<std::string_view> split(std::string_view text, char separator);
std::vector<std::string_view> split(std::string&& text, char separator) = delete;

/// A whole text as a number; nothing when any character is left over or the value does not fit.
[[nodiscard]] std::optional<std::int64_t> parse_integer(std::string_view text);
/// "nan" and "inf" are numbers here: callers check what they allow.
[[nodiscard]] std::optional<double> parse_number(std::string_view text);

}  // namespace splatlas

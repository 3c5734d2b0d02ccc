// Line breaks of annotations.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace splatlas {

/// Breaks UTF-8 text into lines of at most `max_width`, at blanks. A longer word is broken between
/// characters. A line has at least one character. `width_of` gives the width of a line.
[[nodiscard]] std::vector<std::string> wrap_text(std::string_view text, double max_width,
                                                 const std::function<double(std::string_view)>& width_of);

/// The same number of lines, but as equally long as possible.
[[nodiscard]] std::vector<std::string> balanced_lines(
    std::string_view text, double max_width, const std::function<double(std::string_view)>& width_of);

/// The longest beginning of the text that fits with an ellipsis; the whole text if it fits.
[[nodiscard]] std::string shortened_text(std::string_view text, double max_width,
                                         const std::function<double(std::string_view)>& width_of);

}  // namespace splatlas

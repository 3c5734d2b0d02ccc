#include "player/page/wrap_text.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "format/tasks/task_control.h"

namespace splatlas {
namespace {

/// The end of the UTF-8 character that holds the byte before `bytes`.
std::size_t whole_characters(std::string_view text, std::size_t bytes) {
  while (bytes < text.size() && (static_cast<unsigned char>(text[bytes]) & 0xc0u) == 0x80u) ++bytes;
  return std::min(bytes, text.size());
}

/// Bytes of the longest beginning of whole characters that `fits`. The cost follows the beginning, not the
/// text: exponential and binary search.
template <typename Fits>
std::size_t fitting(std::string_view text, const Fits& fits) {
  std::size_t most = 0, beyond = whole_characters(text, 1);  // fits; does not fit
  while (fits(beyond)) {
    most = beyond;
    if (most == text.size()) return most;
    beyond = whole_characters(text, 2 * most);
  }
  while (whole_characters(text, most + 1) < beyond) {
    std::size_t middle = whole_characters(text, (most + beyond) / 2);
    if (middle == beyond) middle = whole_characters(text, most + 1);
    (fits(middle) ? most : beyond) = middle;
  }
  return most;
}

}  // namespace

std::vector<std::string> wrap_text(std::string_view text, double max_width,
                                   const std::function<double(std::string_view)>& width_of) {
  std::vector<std::string> lines;
  std::string line;
  while (!text.empty()) {
    check_task();
    const std::size_t blank = text.find(' ');
    std::string_view word = text.substr(0, blank);
    text = blank == std::string_view::npos ? std::string_view() : text.substr(blank + 1);
    if (word.empty()) continue;
    const std::string longer = line.empty() ? std::string(word) : line + " " + std::string(word);
    if (width_of(longer) <= max_width) {
      line = longer;
      continue;
    }
    if (!line.empty()) lines.push_back(line);
    while (true) {
      const auto fits = [&](std::size_t bytes) { return width_of(word.substr(0, bytes)) <= max_width; };
      const std::size_t end = std::max(whole_characters(word, 1), fitting(word, fits));
      if (end == word.size()) break;
      lines.emplace_back(word.substr(0, end));
      word.remove_prefix(end);
    }
    line = word;
  }
  if (!line.empty()) lines.push_back(line);
  return lines;
}

std::vector<std::string> balanced_lines(std::string_view text, double max_width,
                                        const std::function<double(std::string_view)>& width_of) {
  // The longest word is the narrowest line, unless it has to be broken
  double narrow = 0;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    narrow = std::max(narrow, width_of(text.substr(at, end - at)));
    at = end + 1;
  }
  narrow = std::min(narrow, max_width);
  double wide = max_width;
  std::vector<std::string> lines = wrap_text(text, wide, width_of);
  constexpr int kSteps = 12;
  for (int step = 0; step < kSteps && lines.size() > 1; ++step) {
    const double middle = 0.5 * (narrow + wide);
    auto narrower = wrap_text(text, middle, width_of);
    const bool same = narrower.size() == lines.size();
    if (same) lines = std::move(narrower);
    (same ? wide : narrow) = middle;
  }
  return lines;
}

std::string shortened_text(std::string_view text, double max_width,
                           const std::function<double(std::string_view)>& width_of) {
  if (width_of(text) <= max_width) return std::string(text);
  constexpr const char* kEllipsis = "\xe2\x80\xa6";
  std::size_t end = fitting(text, [&](std::size_t bytes) {
    return width_of(std::string(text.substr(0, bytes)) + kEllipsis) <= max_width;
  });
  while (end > 0 && text[end - 1] == ' ') --end;
  return std::string(text.substr(0, end)) + kEllipsis;
}

}  // namespace splatlas

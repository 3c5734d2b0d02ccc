// Colours of structures that their sources leave without one.
#pragma once

#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>

#include <fmt/ranges.h>

#include "format/content/structure_graph.h"
#include "format/text/ascii_text.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {

/// Colours of one atlas.
class DefaultColors {
 public:
  /// The anatomical colour of the name, or else of a term, up to a fifth darker so that structures differ.
  /// Without one, the n-th distinct colour.
  [[nodiscard]] Rgb next(std::string_view name, std::span<const Term> terms, std::size_t n) {
    std::optional<Rgb> color = find(name);
    for (const Term& term : terms) color = color ? color : find(term.value);
    if (!color) return default_color(n);
    Rgb darker = *color;
    for (int tries = 0; tries < 100; ++tries) {
      const double shade = 1 - 0.2 * std::fmod(0.618034 * tries, 1);  // golden steps spread evenly
      const auto channel = [&](std::uint8_t c) { return static_cast<std::uint8_t>(std::lround(shade * c)); };
      darker = {channel(color->r), channel(color->g), channel(color->b)};
      if (given_.insert(to_hex(darker)).second) break;
    }
    return darker;
  }

 private:
  /// Of the entries among the words of a name, that of most words, and of these the last. Entries fit plurals
  /// in "s", and words with a number behind them.
  static std::optional<Rgb> find(std::string_view name) {
    static const std::map<std::string, Rgb> kColorOf = [] {
      constexpr std::string_view kLines =
#include "preprocess/structures/anatomical_colors.txt"
          ;
      std::map<std::string, Rgb> colors;
      for (const std::string_view line : split(kLines, '\n')) {
        for (const std::string_view entry : split(line, '|'))  // the first is the colour itself
          colors.emplace(entry, *parse_color(line.substr(0, 7)));
      }
      return colors;
    }();
    std::vector<std::string> words = words_of(name);
    for (std::string& word : words)  // "rib12"
      word.resize(std::min(word.find_last_not_of("0123456789"), word.size() - 1) + 1);
    for (std::size_t count = std::min<std::size_t>(words.size(), 5); count > 0; --count) {
      for (std::size_t end = words.size(); end >= count; --end) {
        const std::string entry =
            fmt::format("{}", fmt::join(std::span(words).subspan(end - count, count), " "));
        auto found = kColorOf.find(entry);
        if (found == kColorOf.end() && entry.ends_with('s'))
          found = kColorOf.find(entry.substr(0, entry.size() - 1));
        if (found != kColorOf.end()) return found->second;
      }
    }
    return std::nullopt;
  }

  std::set<std::string> given_;
};

}  // namespace splatlas

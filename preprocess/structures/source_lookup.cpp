#include <algorithm>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "format/result_macros.h"
#include "format/selection/glob.h"
#include "format/text/ascii_text.h"
#include "preprocess/import/tables/text_file.h"
#include "preprocess/structures/graph_parts.h"

namespace splatlas {
namespace {

/// Adds a key, or marks it as ambiguous if another source has it.
template <typename Map, typename Key>
void add_or_mark(Map& map, const Key& key, StructureIndex source) {
  const auto [entry, is_new] = map.emplace(key, source);
  if (!is_new && entry->second != source) entry->second = kNoStructure;
}

template <typename Map, typename Key>
std::optional<StructureIndex> find_only(const Map& map, const Key& key) {
  const auto found = map.find(key);
  if (found == map.end() || found->second == kNoStructure) return std::nullopt;
  return found->second;
}

}  // namespace

/// Of the entries among the words of a name, that of most words, and of these the last. Entries fit plurals
/// in "s", and words with a number behind them.
std::optional<Rgb> anatomical_color(std::string_view name, std::span<const Term> terms) {
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
  if (terms.empty()) return std::nullopt;
  return anatomical_color(terms.front().value, terms.subspan(1));
}

SourceLookup::SourceLookup(std::span<const SourceStructure> sources, StructureGraph flat,
                           const std::string* group)
    : sources_(sources), flat_(std::move(flat)) {
  for (StructureIndex n = 0; n < sources_.size(); ++n) {
    ids_.push_back(to_lower(flat_[n].id));
    names_.push_back(to_lower(sources_[n].name));
    if (sources_[n].whole || (group != nullptr && sources_[n].group != *group)) continue;
    source_of_id_.emplace(ids_[n], n);
    add_or_mark(source_of_name_, names_[n], n);
    if (sources_[n].label) add_or_mark(source_of_label_, *sources_[n].label, n);
    for (const Term& term : sources_[n].terms) add_or_mark(source_of_term_, to_lower(term.value), n);
  }
}

std::optional<StructureIndex> SourceLookup::named(std::string_view text) const {
  if (text.find('*') != std::string_view::npos) return std::nullopt;
  const std::string key = to_lower(text);
  const auto by_id = find_only(source_of_id_, key);
  return by_id ? by_id : find_only(source_of_name_, key);
}

std::optional<StructureIndex> SourceLookup::labelled(std::int64_t label) const {
  return find_only(source_of_label_, label);
}

Result<std::vector<StructureIndex>> SourceLookup::matching(std::string_view conditions) const {
  std::vector<StructureIndex> found;
  std::vector<std::size_t> hits(sources_.size(), 0);
  const std::vector<std::string_view> parts = split(conditions, '&');
  for (std::size_t n = 0; n < parts.size(); ++n) {
    SPLATLAS_ASSIGN_OR_RETURN(const std::vector<StructureIndex> fitting, matching_one(parts[n]));
    if (n == 0) found = fitting;
    for (const StructureIndex source : fitting) ++hits[source];
  }
  std::erase_if(found, [&](StructureIndex source) { return hits[source] < parts.size(); });
  return found;
}

Result<std::vector<StructureIndex>> SourceLookup::matching_one(std::string_view condition) const {
  constexpr std::string_view kCode = "code:";
  if (condition.starts_with(kCode)) return with_codes(condition.substr(kCode.size()));
  if (condition.find('*') != std::string_view::npos) {
    const Glob pattern(condition);
    const auto filter = [&](const auto& fits_source) {
      std::vector<StructureIndex> found;
      for (StructureIndex n = 0; n < sources_.size(); ++n) {
        if (!sources_[n].whole && fits_source(n)) found.push_back(n);
      }
      return found;
    };
    auto found =
        filter([&](StructureIndex n) { return pattern.matches(ids_[n]) || pattern.matches(names_[n]); });
    if (!found.empty()) return found;
    return filter([&](StructureIndex n) {
      return std::ranges::any_of(sources_[n].terms,
                                 [&](const Term& term) { return pattern.matches(term.value); });
    });
  }
  std::optional<StructureIndex> source = named(condition);
  if (!source && condition.starts_with('#')) {
    const auto label = parse_integer(condition.substr(1));
    if (!label) return fail(ErrorCode::kFailed, "'{}' is no label; write # and a whole number", condition);
    source = labelled(*label);
  }
  if (!source) source = find_only(source_of_term_, to_lower(condition));
  return source ? std::vector{*source} : std::vector<StructureIndex>{};
}

/// Sources with codes in a list such as "2001-2999,3001", sorted by code.
Result<std::vector<StructureIndex>> SourceLookup::with_codes(std::string_view list) const {
  std::vector<std::pair<std::int64_t, StructureIndex>> found;
  for (const std::string_view range : split(list, ',')) {
    const std::size_t dash = range.find('-');
    const auto low = parse_integer(trimmed(range.substr(0, dash)));
    const auto high = dash == std::string_view::npos ? low : parse_integer(trimmed(range.substr(dash + 1)));
    if (!low || !high || *low > *high) {
      return fail(ErrorCode::kFailed, "'{}' is no code and no range of codes", range);
    }
    for (StructureIndex source = 0; source < sources_.size(); ++source) {
      const auto code = sources_[source].code;
      if (code && *code >= *low && *code <= *high) found.emplace_back(*code, source);
    }
  }
  std::sort(found.begin(), found.end());
  std::vector<StructureIndex> indices;
  for (const auto& [code, source] : found) indices.push_back(source);
  indices.erase(std::unique(indices.begin(), indices.end()), indices.end());
  return indices;
}

}  // namespace splatlas

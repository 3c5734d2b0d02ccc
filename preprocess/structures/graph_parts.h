// Construction of a graph: lookup of sources, default colours, and the structures while they are placed.
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "format/content/structure_graph.h"
#include "format/text/ascii_text.h"
#include "preprocess/import/tables/names_table.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {

/// Finds sources, by number. Refers to `sources`. Finds names, ids and terms by hash, patterns by a pass.
class SourceLookup {
 public:
  /// `flat`: the sources as roots of a graph, with their ids. With `group`, finds only sources of this group.
  /// Sides of others are not found.
  SourceLookup(std::span<const SourceStructure> sources, StructureGraph flat,
               const std::string* group = nullptr);

  [[nodiscard]] const StructureGraph& flat() const { return flat_; }
  /// The only source with this id, or else with this name. Nullopt for patterns.
  [[nodiscard]] std::optional<StructureIndex> named(std::string_view text) const;
  /// The only source with this label.
  [[nodiscard]] std::optional<StructureIndex> labelled(std::int64_t label) const;
  [[nodiscard]] bool has_color(StructureIndex source) const { return sources_[source].color.has_value(); }
  /// Sources that fit "name", "*_L", "#17", "code:2001-2999" or several of these joined by "&": sorted by
  /// code for codes, else by number. A name or pattern that fits no name and id may fit terms. Empty if none
  /// fits. kFailed for lists of codes and labels that are malformed.
  [[nodiscard]] Result<std::vector<StructureIndex>> matching(std::string_view conditions) const;

 private:
  [[nodiscard]] Result<std::vector<StructureIndex>> matching_one(std::string_view condition) const;
  [[nodiscard]] Result<std::vector<StructureIndex>> with_codes(std::string_view list) const;

  std::span<const SourceStructure> sources_;
  StructureGraph flat_;
  std::vector<std::string> ids_, names_;  // in lower case, [source]
  std::unordered_map<std::string, StructureIndex> source_of_id_;
  std::unordered_map<std::string, StructureIndex> source_of_name_;  // kNoStructure: several
  std::unordered_map<std::string, StructureIndex> source_of_term_;
  std::unordered_map<std::int64_t, StructureIndex> source_of_label_;
};

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

/// Gives ids from names: "Thalamus", and "Thalamus_2" if that is taken. The order of calls decides.
class UniqueIds {
 public:
  std::string claim(const std::string& name) {
    const std::string base = id_from_name(name);
    std::string id = base;
    int& number = next_number_[to_lower(base)];
    if (number == 0) number = 2;
    while (!taken_.insert(to_lower(id)).second) id = fmt::format("{}_{}", base, number++);
    return id;
  }

 private:
  std::unordered_set<std::string> taken_;
  std::unordered_map<std::string, int> next_number_;
};

/// Numbers sources and groups by their first use, and collects their parents.
class GraphParts {
 public:
  GraphParts(const StructureGraph& flat, UniqueIds& ids, DefaultColors& colors)
      : flat_(flat), ids_(ids), colors_(colors), index_of_source_(flat.size(), kNoStructure) {}

  /// The structure of a source, placed at its first use.
  StructureIndex place_source(StructureIndex source) {
    StructureIndex& index = index_of_source_[source];
    if (index != kNoStructure) return index;
    index = static_cast<StructureIndex>(structures_.size());
    structures_.push_back(flat_[source]);
    return index;
  }

  /// Its id begins with the name of the group of its label map, `map`.
  StructureIndex add_group(const std::string& name, StructureIndex map = kNoStructure) {
    Structure group;
    group.id = ids_.claim(map == kNoStructure ? name : structures_[map].name + " " + name);
    group.name = name;
    group.color = colors_.next(name, {}, structures_.size());
    structures_.push_back(std::move(group));
    return static_cast<StructureIndex>(structures_.size() - 1);
  }

  void add_parent(StructureIndex child, StructureIndex parent) {
    std::vector<StructureIndex>& parents = structures_[child].parents;
    if (parent == kNoStructure || std::find(parents.begin(), parents.end(), parent) != parents.end()) return;
    parents.push_back(parent);
  }

  [[nodiscard]] bool has_parent(StructureIndex structure) const {
    return !structures_[structure].parents.empty();
  }

  /// A side is below its whole, and has its label and colour.
  void add_side(StructureIndex side, StructureIndex whole) {
    add_parent(side, whole);
    structures_[side].label = structures_[whole].label;
    structures_[side].color = structures_[whole].color;
  }

  void set_color(StructureIndex structure, Rgb color) { structures_[structure].color = color; }

  /// Places the sources that no line mentions. The structures and [source number]: structure.
  std::pair<std::vector<Structure>, std::vector<StructureIndex>> finish() {
    for (StructureIndex n = 0; n < index_of_source_.size(); ++n) place_source(n);
    return {std::move(structures_), std::move(index_of_source_)};
  }

 private:
  const StructureGraph& flat_;
  UniqueIds& ids_;
  DefaultColors& colors_;
  std::vector<Structure> structures_;
  std::vector<StructureIndex> index_of_source_;
};

}  // namespace splatlas

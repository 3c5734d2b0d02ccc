// Construction of a graph: anatomical colours, lookup of sources, and the structures while they are placed.
#pragma once

#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "format/content/structure_graph.h"
#include "format/text/ascii_text.h"
#include "preprocess/import/tables/names_table.h"

namespace splatlas {

/// The colour of the name in anatomical_colors.txt, or else of a term.
[[nodiscard]] std::optional<Rgb> anatomical_color(std::string_view name, std::span<const Term> terms);

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
  GraphParts(const StructureGraph& flat, UniqueIds& ids)
      : flat_(flat), ids_(ids), index_of_source_(flat.size(), kNoStructure) {}

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
    group.color = anatomical_color(name, {}).value_or(default_color(structures_.size()));
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

  void set_color(StructureIndex structure, Rgb color) {
    structures_[structure].color = color;
    colored_.insert(structure);
  }

  /// Places the sources that no line mentions. The structures and [source number]: structure.
  auto finish() {
    for (StructureIndex n = 0; n < index_of_source_.size(); ++n) place_source(n);
    return std::tuple(std::move(structures_), std::move(index_of_source_), std::move(colored_));
  }

 private:
  const StructureGraph& flat_;
  UniqueIds& ids_;
  std::vector<Structure> structures_;
  std::vector<StructureIndex> index_of_source_;
  std::unordered_set<StructureIndex> colored_;  // by the tree
};

}  // namespace splatlas

// Structures of a graph while sources and groups are placed.
#pragma once

#include <algorithm>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "format/content/structure_graph.h"
#include "format/text/ascii_text.h"
#include "preprocess/structures/default_colors.h"

namespace splatlas {

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

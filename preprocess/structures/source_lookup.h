// Lookup of source structures by name, id, label, code, term and pattern.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "format/content/structure_graph.h"
#include "preprocess/import/tables/names_table.h"

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

}  // namespace splatlas

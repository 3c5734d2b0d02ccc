// Trees written by tests, for the graph of six structures.
#pragma once

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "preprocess/structures/build_graph.h"
#include "tests/preprocess/messages_of_notes.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

namespace splatlas {

/// Six structures with names and codes in the style of AAL.
inline std::vector<SourceStructure> sources_of_aal() {
  std::vector<SourceStructure> result;
  for (const auto& [name, code] : {std::pair<const char*, int>{"Precentral_L", 2001},
                                   {"Precentral_R", 2002},
                                   {"Insula_L", 3001},
                                   {"Insula_R", 3002},
                                   {"Vermis_3", 9110},
                                   {"Rest of brain", 0}}) {
    SourceStructure source;
    source.name = name;
    source.label = static_cast<std::int64_t>(result.size()) + 1;
    if (code != 0) source.code = code;
    if (code / 1000 == 3)
      source.terms = {{"la", "Lobus insularis"}, {"synonym", "Reil" + source.name.substr(6)}};
    result.push_back(source);
  }
  return result;
}

class GraphTest : public testing::Test {
 protected:
  Result<PlacedStructures> build(const std::string& tree) {
    write_bytes(folder_.file("a.tree"), tree);
    notes_ = {};
    const auto lines = read_tree(folder_.file("a.tree"), notes_);
    if (!lines) return tl::unexpected(lines.error());
    return build_graph(sources_of_aal(), *lines, "a.tree", notes_);
  }
  std::string error(const std::string& tree) {
    const auto placed = build(tree);
    return placed ? "no error" : placed.error().message;
  }
  /// Items of a kind of notes.
  [[nodiscard]] std::vector<std::string> items(const std::string& kind) const {
    return items_of(notes_, kind);
  }
  TemporaryFolder folder_;
  Notes notes_;
};

inline StructureIndex named(const StructureGraph& graph, const std::string& name) {
  for (StructureIndex s = 0; s < graph.size(); ++s) {
    if (graph[s].name == name) return s;
  }
  ADD_FAILURE() << "no structure " << name;
  return 0;
}

inline std::vector<std::string> parents_of(const StructureGraph& graph, const std::string& name) {
  std::vector<std::string> parents;
  for (const StructureIndex p : graph[named(graph, name)].parents) parents.push_back(graph[p].name);
  return parents;
}

inline std::vector<std::string> names_below(const StructureGraph& graph, const std::string& name) {
  std::vector<std::string> names;
  for (const StructureIndex s : graph.descendants(named(graph, name))) names.push_back(graph[s].name);
  return names;
}

}  // namespace splatlas

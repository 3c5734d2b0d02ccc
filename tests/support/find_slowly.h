// Brute-force look-up of structures by patterns, ids, names, paths and terms.
#pragma once

#include <algorithm>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "format/content/structure_graph.h"
#include "format/text/ascii_text.h"

namespace splatlas {

/// True if a pattern with "*" for any characters matches a text: tries every length of each "*".
inline bool matches_slowly(std::string_view pattern, std::string_view text) {
  if (pattern.empty()) return text.empty();
  if (pattern[0] == '*') {
    return matches_slowly(pattern.substr(1), text) ||
           (!text.empty() && matches_slowly(pattern, text.substr(1)));
  }
  return !text.empty() && pattern[0] == text[0] && matches_slowly(pattern.substr(1), text.substr(1));
}

/// Adds every path from any structure above (roots only if `whole`) down to `s`, in lower case.
inline void collect_paths(const StructureGraph& graph, StructureIndex s, const std::string& below, bool whole,
                          std::set<std::string>& paths) {
  const std::string path = to_lower(graph[s].name) + below;
  if (!whole || graph[s].parents.empty()) paths.insert(path);
  for (const StructureIndex parent : graph[s].parents) collect_paths(graph, parent, "/" + path, whole, paths);
}

/// The definition of StructureGraph::find(), with all paths written out.
inline std::vector<StructureIndex> find_slowly(const StructureGraph& graph, std::string_view name) {
  const std::string sought = to_lower(name);
  const auto all_that = [&](const auto& fits) {
    std::vector<StructureIndex> found;
    for (StructureIndex s = 0; s < graph.size(); ++s) {
      if (fits(s)) found.push_back(s);
    }
    return found;
  };
  const auto paths = [&](StructureIndex s, bool whole) {
    std::set<std::string> all;
    collect_paths(graph, s, "", whole, all);
    return all;
  };
  const auto with_term = [&] {
    return all_that([&](StructureIndex s) {
      return std::ranges::any_of(
          graph[s].terms, [&](const Term& term) { return matches_slowly(sought, to_lower(term.value)); });
    });
  };
  const bool has_slash = sought.find('/') != std::string::npos;
  if (sought.find('*') != std::string::npos) {
    const auto found = all_that([&](StructureIndex s) {
      std::set<std::string> texts = paths(s, !has_slash);
      texts.insert({to_lower(graph[s].id), to_lower(graph[s].name)});
      return std::ranges::any_of(texts,
                                 [&](const std::string& text) { return matches_slowly(sought, text); });
    });
    return found.empty() ? with_term() : found;
  }
  auto found = all_that([&](StructureIndex s) { return to_lower(graph[s].id) == sought; });
  if (found.empty()) found = all_that([&](StructureIndex s) { return to_lower(graph[s].name) == sought; });
  if (found.empty() && has_slash)
    found = all_that([&](StructureIndex s) { return paths(s, false).contains(sought); });
  return found.empty() ? with_term() : found;
}

}  // namespace splatlas

#include "format/content/structure_graph.h"

#include <algorithm>
#include <limits>
#include <unordered_set>

#include "format/result_macros.h"
#include "format/text/ascii_text.h"

namespace splatlas {
namespace {

Result<void> check_ids(std::span<const Structure> structures) {
  std::unordered_set<std::string> seen;
  seen.reserve(structures.size());
  for (std::size_t s = 0; s < structures.size(); ++s) {
    const std::string& id = structures[s].id;
    if (id.empty()) return invalid_atlas("structure {} ({}) has no id", s, in_quotes(structures[s].name));
    const bool well_formed = std::all_of(id.begin(), id.end(), [](char c) {
      return is_ascii_letter_or_digit(c) || c == '_' || c == '-' || c == '.';
    });
    if (!well_formed) {
      return invalid_atlas(
          "the id {} of a structure holds other characters than letters, digits, \"_\", \"-\" and \".\"",
          in_quotes(id));
    }
    if (!seen.insert(to_lower(id)).second) {
      return invalid_atlas("two structures have the id {} (case does not count)", in_quotes(id));
    }
  }
  return {};
}

Result<void> check_parents(std::span<const Structure> structures) {
  std::vector<StructureIndex> last_child(structures.size(), kNoStructure);
  std::size_t edges = 0;
  for (StructureIndex s = 0; s < structures.size(); ++s) {
    for (const StructureIndex parent : structures[s].parents) {
      if (parent >= structures.size()) {
        return invalid_atlas("structure {} has parent number {} of {} structures",
                             in_quotes(structures[s].id), parent, structures.size());
      }
      if (last_child[parent] == s) {
        return invalid_atlas("structure {} has the parent {} twice", in_quotes(structures[s].id),
                             in_quotes(structures[parent].id));
      }
      last_child[parent] = s;
    }
    edges += structures[s].parents.size();
  }
  if (edges > std::numeric_limits<std::uint32_t>::max()) {
    return invalid_atlas("{} parents in all are too many", edges);
  }
  return {};
}

/// Describes a cycle. `waiting[s]` counts the parents of s that are on or below a cycle.
std::string describe_cycle(std::span<const Structure> structures, std::span<const std::uint32_t> waiting) {
  // Follow waiting parents upwards: the first structure that repeats is on a cycle.
  const auto waiting_parent = [&](StructureIndex s) {
    const auto& parents = structures[s].parents;
    return *std::find_if(parents.begin(), parents.end(), [&](StructureIndex p) { return waiting[p] > 0; });
  };
  auto s = static_cast<StructureIndex>(
      std::find_if(waiting.begin(), waiting.end(), [](std::uint32_t n) { return n > 0; }) - waiting.begin());
  std::vector<bool> seen(structures.size());
  for (; !seen[s]; s = waiting_parent(s)) seen[s] = true;

  constexpr int kNamed = 8;
  std::string text = structures[s].id;
  StructureIndex parent = waiting_parent(s);
  for (int n = 1; parent != s && n < kNamed; ++n, parent = waiting_parent(parent)) {
    text += " in " + structures[parent].id;
  }
  if (parent != s) text += " in ...";
  return text + " in " + structures[s].id;
}

}  // namespace

/// Depth-first preorder from `starts` over the structures for which is_new() returns true when visited.
template <typename IsNew>
std::vector<StructureIndex> StructureGraph::walk(std::span<const StructureIndex> starts,
                                                 const IsNew& is_new) const {
  std::vector<StructureIndex> visited;
  std::vector<StructureIndex> stack(starts.rbegin(), starts.rend());
  while (!stack.empty()) {
    const StructureIndex s = stack.back();
    stack.pop_back();
    if (!is_new(s)) continue;
    visited.push_back(s);
    const auto below = children(s);
    stack.insert(stack.end(), below.rbegin(), below.rend());
  }
  return visited;
}

Result<StructureGraph> StructureGraph::build(std::vector<Structure> structures) {
  if (structures.size() > kMaxStructures) {
    return invalid_atlas("{} structures; at most {} are allowed", structures.size(), kMaxStructures);
  }
  SPLATLAS_RETURN_IF_ERROR(check_ids(structures));
  SPLATLAS_RETURN_IF_ERROR(check_parents(structures));
  StructureGraph graph;
  graph.structures_ = std::move(structures);
  graph.list_children();
  SPLATLAS_RETURN_IF_ERROR(graph.sort_topologically());
  std::vector<std::uint8_t> seen(graph.size());
  graph.preorder_ =
      graph.walk(graph.roots_, [&](StructureIndex s) { return std::exchange(seen[s], 1) == 0; });
  return graph;
}

void StructureGraph::list_children() {
  const std::size_t n = structures_.size();
  first_child_.assign(n + 1, 0);
  for (StructureIndex s = 0; s < n; ++s) {
    if (structures_[s].parents.empty()) roots_.push_back(s);
    for (const StructureIndex parent : structures_[s].parents) ++first_child_[parent + 1];
  }
  for (std::size_t s = 0; s < n; ++s) first_child_[s + 1] += first_child_[s];
  children_.resize(first_child_[n]);
  std::vector<std::uint32_t> next(first_child_.begin(), first_child_.end() - 1);
  for (StructureIndex s = 0; s < n; ++s) {
    for (const StructureIndex parent : structures_[s].parents) children_[next[parent]++] = s;
  }
}

Result<void> StructureGraph::sort_topologically() {
  // Kahn's algorithm, level by level. `waiting` counts the parents of a structure that are not yet sorted.
  std::vector<std::uint32_t> waiting(size());
  for (StructureIndex s = 0; s < size(); ++s)
    waiting[s] = static_cast<std::uint32_t>(structures_[s].parents.size());
  topological_ = roots_;
  topological_.reserve(size());
  std::size_t depth = 0;
  for (std::size_t done = 0; done < topological_.size();) {
    if (++depth > kMaxGraphDepth) {
      return invalid_atlas("structure {} lies deeper than {} levels",
                           in_quotes(structures_[topological_[done]].id), kMaxGraphDepth);
    }
    for (const std::size_t level_end = topological_.size(); done < level_end; ++done) {
      for (const StructureIndex child : children(topological_[done])) {
        if (--waiting[child] == 0) topological_.push_back(child);
      }
    }
  }
  if (topological_.size() < size()) {
    return invalid_atlas("structures form a cycle: {}", describe_cycle(structures_, waiting));
  }
  return {};
}

std::span<const StructureIndex> StructureGraph::children(StructureIndex s) const {
  return std::span(children_).subspan(first_child_[s], first_child_[s + 1] - first_child_[s]);
}

std::vector<StructureIndex> StructureGraph::descendants(StructureIndex s) const {
  return descendants({&s, 1});
}

std::vector<StructureIndex> StructureGraph::descendants(std::span<const StructureIndex> structures) const {
  std::unordered_set<StructureIndex> seen;  // a set, because a subtree may be small
  return walk(structures, [&](StructureIndex below) { return seen.insert(below).second; });
}

std::vector<std::string> StructureGraph::paths(StructureIndex s, std::size_t limit) const {
  struct Step {
    StructureIndex structure;
    std::size_t next_parent;
  };
  std::vector<std::string> result;
  std::vector<Step> stack{{s, 0}};  // depth-first stack from s upwards, parents in order
  while (!stack.empty() && result.size() < limit) {
    auto& [here, next_parent] = stack.back();
    const auto& parents = structures_[here].parents;
    if (next_parent < parents.size()) {
      const StructureIndex parent = parents[next_parent++];
      stack.push_back({parent, 0});
      continue;
    }
    if (parents.empty()) {
      std::string path = structures_[here].name;
      for (auto step = stack.rbegin() + 1; step != stack.rend(); ++step)
        path += "/" + structures_[step->structure].name;
      result.push_back(std::move(path));
    }
    stack.pop_back();
  }
  return result;
}

std::string id_from_name(std::string_view name) {
  std::string id;
  bool gap = false;
  for (const char c : name) {
    if (!is_ascii_letter_or_digit(c)) {
      gap = true;
      continue;
    }
    if (gap && !id.empty()) id += '_';
    gap = false;
    id += c;
  }
  return id.empty() ? "structure" : id;
}

}  // namespace splatlas

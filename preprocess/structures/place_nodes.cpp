#include "preprocess/structures/place_nodes.h"

#include <unordered_map>

#include <fmt/format.h>

#include "format/text/ascii_text.h"
#include "preprocess/import/import_error.h"

namespace splatlas {
namespace {

const NoteKind kUnusedNodes{"tree-entries-unused", "entry of the tree has no structure and is left out",
                            "entries of the tree have no structure and are left out", false};
const NoteKind kUnknownParents{"tree-parents-unknown", "parent in the tree does not exist",
                               "parents in the tree do not exist", true};
const NoteKind kCircles{"tree-circles", "parent in the tree is below its child and is left out",
                        "parents in the tree are below their children and are left out", true};

struct Node {
  StructureIndex source = kNoStructure;
  std::vector<std::size_t> parents;
  bool is_used = false;  // a structure, or above one
};

class NodePlacer {
 public:
  NodePlacer(std::span<const TreeLine> lines, const SourceLookup& sources, Notes& notes)
      : lines_(lines), sources_(sources), notes_(notes), nodes_(lines.size()) {}

  /// False if no node fits a structure.
  bool resolve() {
    for (std::size_t n = 0; n < lines_.size(); ++n) node_of_key_.emplace(lines_[n].node->key, n);
    for (std::size_t n = 0; n < lines_.size(); ++n) resolve_node(n);
    break_circles();
    bool fits = false;
    for (std::size_t n = 0; n < nodes_.size(); ++n) {
      if (nodes_[n].source == kNoStructure) continue;
      fits = true;
      mark_upwards(n);
    }
    return fits;
  }

  void place(GraphParts& parts) {
    std::vector<StructureIndex> index_of_node(nodes_.size(), kNoStructure);
    for (std::size_t n = 0; n < nodes_.size(); ++n) {
      const TreeLine& line = lines_[n];
      if (!nodes_[n].is_used) {
        notes_.add(kUnusedNodes, in_quotes(line.node->name));
        continue;
      }
      const bool is_group = nodes_[n].source == kNoStructure;
      index_of_node[n] = is_group ? parts.add_group(line.node->name) : parts.place_source(nodes_[n].source);
      const bool has_color = !is_group && sources_.has_color(nodes_[n].source);
      if (line.color && !has_color) parts.set_color(index_of_node[n], line.color->first);
    }
    for (std::size_t n = 0; n < nodes_.size(); ++n) {
      if (!nodes_[n].is_used) continue;
      for (const std::size_t parent : nodes_[n].parents) {
        if (index_of_node[parent] != index_of_node[n])
          parts.add_parent(index_of_node[n], index_of_node[parent]);
      }
    }
  }

 private:
  void resolve_node(std::size_t n) {
    const TreeNode& node = *lines_[n].node;
    if (node.label) {
      nodes_[n].source = sources_.labelled(*node.label).value_or(kNoStructure);
      const auto named = sources_.named(node.name);
      const bool is_unlabelled = named && !sources_.flat()[*named].label;  // a mask
      if (nodes_[n].source == kNoStructure && is_unlabelled) nodes_[n].source = *named;
    } else {
      nodes_[n].source = sources_.named(node.name).value_or(kNoStructure);
    }
    for (const std::string& key : node.parents) {
      const auto parent = node_of_key_.find(key);
      if (parent == node_of_key_.end()) {
        notes_.add(kUnknownParents, fmt::format("{} of {}", in_quotes(key), in_quotes(node.name)));
      } else if (parent->second != n) {
        nodes_[n].parents.push_back(parent->second);
      }
    }
  }

  /// Walks from every node to its ancestors, depth first, and drops edges back to the way walked.
  void break_circles() {
    enum class State : std::uint8_t { kNew, kOpen, kDone };
    std::vector<State> states(nodes_.size(), State::kNew);
    std::vector<std::pair<std::size_t, std::size_t>> way;  // node, next parent
    for (std::size_t start = 0; start < nodes_.size(); ++start) {
      if (states[start] == State::kNew) way.emplace_back(start, 0);
      while (!way.empty()) {
        auto& [n, next] = way.back();
        states[n] = State::kOpen;
        std::vector<std::size_t>& parents = nodes_[n].parents;
        if (next == parents.size()) {
          states[n] = State::kDone;
          way.pop_back();
        } else if (const std::size_t parent = parents[next]; states[parent] == State::kOpen) {
          notes_.add(kCircles, fmt::format("{} of {}", in_quotes(lines_[parent].node->name),
                                           in_quotes(lines_[n].node->name)));
          parents.erase(parents.begin() + static_cast<std::ptrdiff_t>(next));
        } else {
          ++next;
          if (states[parent] == State::kNew) way.emplace_back(parent, 0);
        }
      }
    }
  }

  void mark_upwards(std::size_t start) {
    std::vector<std::size_t> pending{start};
    while (!pending.empty()) {
      Node& node = nodes_[pending.back()];
      pending.pop_back();
      if (node.is_used) continue;
      node.is_used = true;
      pending.insert(pending.end(), node.parents.begin(), node.parents.end());
    }
  }

  std::span<const TreeLine> lines_;
  const SourceLookup& sources_;
  Notes& notes_;
  std::vector<Node> nodes_;
  std::unordered_map<std::string, std::size_t> node_of_key_;
};

}  // namespace

Result<void> place_nodes(std::span<const TreeLine> lines, const std::string& file,
                         const SourceLookup& sources, GraphParts& parts, Notes& notes) {
  if (lines.empty()) return {};
  NodePlacer placer(lines, sources, notes);
  if (!placer.resolve()) {
    return bad_file(
        file,
        "none of its {} entries fits a structure by label or name; the first is {}; check that it "
        "belongs to these labels",
        lines.size(), in_quotes(lines.front().node->name));
  }
  placer.place(parts);
  return {};
}

}  // namespace splatlas

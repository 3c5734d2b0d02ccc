#include "preprocess/structures/build_graph.h"

#include <algorithm>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include <fmt/format.h>

#include "format/content/selection.h"
#include "format/result_macros.h"
#include "format/text/ascii_text.h"
#include "preprocess/import/tables/text_file.h"
#include "preprocess/structures/graph_parts.h"

namespace splatlas {
namespace {

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
    for (const bool has_label : {true, false}) {
      for (std::size_t n = 0; n < lines_.size(); ++n) {
        if (lines_[n].node->label.has_value() == has_label) find_source(n);
      }
    }
    for (std::size_t n = 0; n < lines_.size(); ++n) find_parents(n);
    break_circles();
    bool fits = false;
    for (std::size_t n = 0; n < nodes_.size(); ++n) {
      if (nodes_[n].source == kNoStructure) continue;
      fits = true;
      mark_upwards(n);
    }
    return fits;
  }

  /// Roots go below `group`, if there is one.
  void place(GraphParts& parts, StructureIndex group) {
    std::vector<StructureIndex> index_of_node(nodes_.size(), kNoStructure);
    for (std::size_t n = 0; n < nodes_.size(); ++n) {
      const TreeLine& line = lines_[n];
      if (!nodes_[n].is_used) {
        notes_.add("tree-entries-unused", in_quotes(line.node->name));
        continue;
      }
      const bool is_group = nodes_[n].source == kNoStructure;
      index_of_node[n] =
          is_group ? parts.add_group(line.node->name, group) : parts.place_source(nodes_[n].source);
      const bool has_color = !is_group && sources_.has_color(nodes_[n].source);
      if (line.color && !has_color) parts.set_color(index_of_node[n], line.color->first);
    }
    for (std::size_t n = 0; n < nodes_.size(); ++n) {
      if (!nodes_[n].is_used) continue;
      for (const std::size_t parent : nodes_[n].parents) {
        if (index_of_node[parent] != index_of_node[n])
          parts.add_parent(index_of_node[n], index_of_node[parent]);
      }
      if (!parts.has_parent(index_of_node[n])) parts.add_parent(index_of_node[n], group);
    }
  }

 private:
  /// A node with a label takes its structure, one without by its name; then it is none that another node
  /// takes: a group may have its member's name.
  void find_source(std::size_t n) {
    const TreeNode& node = *lines_[n].node;
    StructureIndex& source = nodes_[n].source;
    if (node.label) source = sources_.labelled(*node.label).value_or(kNoStructure);
    if (source == kNoStructure) {
      const auto named = sources_.named(node.name);
      const bool fits = named && (!node.label || !sources_.flat()[*named].label);  // a mask
      if (fits && !taken_.contains(*named)) source = *named;
    }
    if (source != kNoStructure) taken_.insert(source);
  }

  void find_parents(std::size_t n) {
    const TreeNode& node = *lines_[n].node;
    for (const std::string& key : node.parents) {
      const auto parent = node_of_key_.find(key);
      if (parent == node_of_key_.end()) {
        notes_.add("tree-parents-unknown", fmt::format("{} of {}", in_quotes(key), in_quotes(node.name)));
      } else if (parent->second != n) {
        nodes_[n].parents.push_back(parent->second);
      }
    }
  }

  /// Walks from every node to its descendants, depth first, and drops edges back to the way walked: the roots
  /// first, then the nodes of circles in the order of the file.
  void break_circles() {
    enum class State : std::uint8_t { kNew, kOpen, kDone };
    std::vector<State> states(nodes_.size(), State::kNew);
    std::vector<std::vector<std::size_t>> children(nodes_.size());
    for (std::size_t n = 0; n < nodes_.size(); ++n) {
      for (const std::size_t parent : nodes_[n].parents) children[parent].push_back(n);
    }
    std::vector<std::pair<std::size_t, std::size_t>> way;  // node, next child
    const auto walk_from = [&](std::size_t start) {
      if (states[start] == State::kNew) way.emplace_back(start, 0);
      while (!way.empty()) {
        auto& [n, next] = way.back();
        states[n] = State::kOpen;
        if (next == children[n].size()) {
          states[n] = State::kDone;
          way.pop_back();
          continue;
        }
        const std::size_t child = children[n][next++];
        if (states[child] == State::kOpen) {
          notes_.add("tree-circles", fmt::format("{} of {}", in_quotes(lines_[n].node->name),
                                                 in_quotes(lines_[child].node->name)));
          std::erase(nodes_[child].parents, n);
        } else if (states[child] == State::kNew) {
          way.emplace_back(child, 0);
        }
      }
    };
    for (const bool is_root : {true, false}) {
      for (std::size_t n = 0; n < nodes_.size(); ++n) {
        if (nodes_[n].parents.empty() == is_root) walk_from(n);
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
  std::unordered_set<StructureIndex> taken_;
};

/// Places structures by the nodes with their labels, or else their names, below `group`. Nodes without a
/// structure are groups if a structure is below them; otherwise they are left out and counted as a note, as
/// are missing parents and edges that close a circle. kFailed if no node fits. Linear in nodes and parents.
Result<void> place_nodes(std::span<const TreeLine> lines, const std::string& file,
                         const SourceLookup& sources, StructureIndex group, GraphParts& parts, Notes& notes) {
  NodePlacer placer(lines, sources, notes);
  if (!placer.resolve()) {
    return bad_file(
        file,
        "none of its {} entries fits a structure by label or name; the first is {}; check that it "
        "belongs to these labels",
        lines.size(), in_quotes(lines.front().node->name));
  }
  placer.place(parts, group);
  return {};
}

/// The colour of the n-th of `count` structures.
Rgb between(const ColorRange& range, std::size_t n, std::size_t count) {
  const auto mix = [&](std::uint8_t a, std::uint8_t b) {
    const double t = count > 1 ? static_cast<double>(n) / static_cast<double>(count - 1) : 0.0;
    return static_cast<std::uint8_t>(a + (b - a) * t + 0.5);
  };
  return {mix(range.first.r, range.last.r), mix(range.first.g, range.last.g),
          mix(range.first.b, range.last.b)};
}

/// Places structures below groups. A group is known by its path; with a source's name, it is that source.
class PathPlacer {
 public:
  PathPlacer(const SourceLookup& sources, GraphParts& parts, Notes& notes)
      : sources_(sources), parts_(parts), notes_(notes) {}

  StructureIndex root(const std::string& name) { return place_group(child_of(kNoGroup, name, true)); }

  /// Places all lines. Lines that fit no structure are counted as notes. kFailed, with the line, for
  /// malformed lists of codes, and if lines name members and none fits. Messages call the tree file `file`.
  /// Cost: linear in the lines; a line with a pattern or codes takes a pass over the sources.
  [[nodiscard]] Result<void> place(std::span<const TreeLine> lines, const std::string& file) {
    for (const TreeLine& line : lines) {  // first: a member may name a group that a later line defines
      GroupId group = kNoGroup;
      for (const std::string& name : line.groups) group = child_of(group, name, true);
    }
    for (const TreeLine& line : lines) {
      if (const auto placed = place_line(line); !placed) {
        return bad_file(file, "line {}: {}", line.number, placed.error().message);
      }
    }
    if (placed_ == 0 && first_unused_ != nullptr) {
      const std::string& member = first_unused_->member;
      const auto nearest = sources_.flat().find(member);
      return bad_file(file, "line {}: {}; no line fits a structure", first_unused_->number,
                      nearest ? fmt::format("no structure fits '{}'", member) : nearest.error().message);
    }
    return {};
  }

 private:
  using GroupId = std::size_t;

  struct Group {
    std::string name;
    StructureIndex source = kNoStructure;
    StructureIndex index = kNoStructure;
  };

  /// The group of a name below another; made if `make`. kNoGroup without it.
  GroupId child_of(GroupId parent, const std::string& name, bool make) {
    const std::string key = to_lower(name);
    const std::optional<StructureIndex> source = sources_.named(name);
    const std::string path = source ? fmt::format("source {}", *source) : fmt::format("{}/{}", parent, key);
    const auto found = group_of_path_.find(path);
    if (found != group_of_path_.end()) return found->second;
    if (!make) return kNoGroup;
    const GroupId group = groups_.size();
    groups_.push_back({name, source.value_or(kNoStructure), kNoStructure});
    group_of_path_.emplace(path, group);
    if (!source) groups_of_name_[key].push_back(group);
    return group;
  }

  StructureIndex place_group(GroupId id) {
    Group& group = groups_[id];
    if (group.index == kNoStructure) {
      group.index =
          group.source == kNoStructure ? parts_.add_group(group.name) : parts_.place_source(group.source);
    }
    return group.index;
  }

  /// Structures of the last part: the group of this very path, the only group of this name, or sources.
  Result<std::vector<StructureIndex>> find_members(const TreeLine& line, GroupId parent) {
    if (const GroupId same = child_of(parent, line.member, false); same != kNoGroup) {
      ++placed_;
      return std::vector{place_group(same)};
    }
    const auto named = groups_of_name_.find(to_lower(line.member));
    if (named != groups_of_name_.end() && named->second.size() == 1) {
      ++placed_;
      return std::vector{place_group(named->second.front())};
    }
    SPLATLAS_ASSIGN_OR_RETURN(std::vector<StructureIndex> found, sources_.matching(line.member));
    if (found.empty()) {
      const std::size_t groups = named == groups_of_name_.end() ? 0 : named->second.size();
      if (first_unused_ == nullptr) first_unused_ = &line;
      notes_.add("tree-lines-unused",
                 fmt::format("line {}, {}{}", line.number, in_quotes(line.member),
                             groups > 1 ? fmt::format(" (which is the name of {} groups)", groups) : ""));
    }
    placed_ += found.size();
    for (StructureIndex& index : found) index = parts_.place_source(index);
    return found;
  }

  [[nodiscard]] Result<void> place_line(const TreeLine& line) {
    GroupId group = kNoGroup;
    StructureIndex parent = kNoStructure;
    for (const std::string& name : line.groups) {
      group = child_of(group, name, false);
      const StructureIndex index = place_group(group);
      parts_.add_parent(index, parent);
      parent = index;
    }
    if (line.member.empty()) {
      if (line.color) parts_.set_color(parent, line.color->first);
      return {};
    }
    SPLATLAS_ASSIGN_OR_RETURN(const std::vector<StructureIndex> members, find_members(line, group));
    for (std::size_t n = 0; n < members.size(); ++n) {
      parts_.add_parent(members[n], parent);
      if (line.color) parts_.set_color(members[n], between(*line.color, n, members.size()));
    }
    return {};
  }

  static constexpr GroupId kNoGroup = ~GroupId{0};

  const SourceLookup& sources_;
  GraphParts& parts_;
  Notes& notes_;
  std::vector<Group> groups_;
  std::unordered_map<std::string, GroupId> group_of_path_;
  std::unordered_map<std::string, std::vector<GroupId>> groups_of_name_;  // in lower case; no sources
  std::size_t placed_ = 0;                                                // members
  const TreeLine* first_unused_ = nullptr;
};

/// Graph of the sources without parents, for lookups by name and pattern.
Result<StructureGraph> graph_of_sources(std::span<const SourceStructure> sources, UniqueIds& ids) {
  std::vector<Structure> structures;
  for (const SourceStructure& source : sources) {
    Structure structure;
    structure.id = ids.claim(source.group.empty() ? source.name : source.group + " " + source.name);
    structure.name = source.name;
    const std::optional<Rgb> color =
        source.color ? source.color : anatomical_color(source.name, source.terms);
    structure.color = color.value_or(default_color(structures.size()));
    structure.label = source.label;
    structure.external = source.external;
    structure.terms = source.terms;
    structures.push_back(std::move(structure));
  }
  return StructureGraph::build(std::move(structures));
}

}  // namespace

Result<PlacedStructures> build_graph(std::span<const SourceStructure> sources,
                                     std::span<const TreeLine> lines, const std::string& file, Notes& notes) {
  UniqueIds ids;
  SPLATLAS_ASSIGN_OR_RETURN(StructureGraph flat, graph_of_sources(sources, ids));
  const SourceLookup lookup(sources, std::move(flat));
  GraphParts parts(lookup.flat(), ids);
  std::vector<TreeLine> paths;
  std::vector<TreeLine> nodes;
  for (const TreeLine& line : lines) (line.node ? nodes : paths).push_back(line);
  PathPlacer path_placer(lookup, parts, notes);
  std::vector<std::string> groups;  // of label maps; "" for none
  for (const SourceStructure& source : sources) {
    if (std::ranges::find(groups, source.group) == groups.end()) groups.push_back(source.group);
  }
  const auto root = [&](const std::string& group) {
    return group.empty() ? kNoStructure : path_placer.root(group);
  };
  for (const std::string& group : groups) root(group);
  SPLATLAS_RETURN_IF_ERROR(path_placer.place(paths, file));
  for (const std::string& group : groups) {
    if (nodes.empty() || (group.empty() && groups.size() > 1)) continue;  // beside label maps
    const SourceLookup of_group(sources, lookup.flat(), &group);
    SPLATLAS_RETURN_IF_ERROR(place_nodes(nodes, file, of_group, root(group), parts, notes));
  }
  for (StructureIndex n = 0; n < sources.size(); ++n) {
    const StructureIndex index = parts.place_source(n);
    if (sources[n].whole) {
      parts.add_side(index, parts.place_source(*sources[n].whole));
    } else if (nodes.empty() || !parts.has_parent(index))
      parts.add_parent(index, root(sources[n].group));
  }
  auto [structures, index_of_source, colored] = parts.finish();
  Result<StructureGraph> graph = StructureGraph::build(std::move(structures));
  if (!graph) return bad_file(file, "{}", graph.error().message);
  return PlacedStructures{std::move(*graph), std::move(index_of_source), std::move(colored)};
}

}  // namespace splatlas

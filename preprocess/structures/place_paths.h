// Placement of structures by the paths of a tree file.
#pragma once

#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "preprocess/import/notes.h"
#include "preprocess/import/tables/tree_line.h"
#include "preprocess/structures/graph_parts.h"

namespace splatlas {

/// Places structures below groups. A group is known by its path; one with the name of a source is that
/// source.
class PathPlacer {
 public:
  PathPlacer(const SourceLookup& sources, GraphParts& parts, Notes& notes)
      : sources_(sources), parts_(parts), notes_(notes) {}

  /// Places all lines. Lines that fit no structure are counted as notes. kFailed, with the line, for
  /// malformed lists of codes, and if lines name members and none fits. Messages call the tree file `file`.
  /// Cost: linear in the lines; a line with a pattern or codes takes a pass over the sources.
  [[nodiscard]] Result<void> place(std::span<const TreeLine> lines, const std::string& file);

 private:
  using GroupId = std::size_t;

  struct Group {
    std::string name;
    StructureIndex source = kNoStructure;
    StructureIndex index = kNoStructure;
  };

  /// The group of a name below another; made if `make`. kNoGroup without it.
  GroupId child_of(GroupId parent, const std::string& name, bool make);
  StructureIndex place_group(GroupId group);
  Result<std::vector<StructureIndex>> find_members(const TreeLine& line, GroupId parent);
  [[nodiscard]] Result<void> place_line(const TreeLine& line);

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

}  // namespace splatlas

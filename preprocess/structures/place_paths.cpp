#include "preprocess/structures/place_paths.h"

#include <fmt/format.h>

#include "format/content/selection.h"
#include "format/result_macros.h"
#include "format/text/ascii_text.h"
#include "preprocess/import/import_error.h"

namespace splatlas {
namespace {

const NoteKind kUnusedLines{"tree-lines-unused", "line of the tree fits no structure and is left out",
                            "lines of the tree fit no structure and are left out", true};

/// The colour of the n-th of `count` structures.
Rgb between(const ColorRange& range, std::size_t n, std::size_t count) {
  const auto mix = [&](std::uint8_t a, std::uint8_t b) {
    const double t = count > 1 ? static_cast<double>(n) / static_cast<double>(count - 1) : 0.0;
    return static_cast<std::uint8_t>(a + (b - a) * t + 0.5);
  };
  return {mix(range.first.r, range.last.r), mix(range.first.g, range.last.g),
          mix(range.first.b, range.last.b)};
}

}  // namespace

Result<void> PathPlacer::place(std::span<const TreeLine> lines, const std::string& file) {
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

PathPlacer::GroupId PathPlacer::child_of(GroupId parent, const std::string& name, bool make) {
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

StructureIndex PathPlacer::place_group(GroupId id) {
  Group& group = groups_[id];
  if (group.index == kNoStructure) {
    group.index =
        group.source == kNoStructure ? parts_.add_group(group.name) : parts_.place_source(group.source);
  }
  return group.index;
}

Result<void> PathPlacer::place_line(const TreeLine& line) {
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

/// Structures of the last part: the group of this very path, the only group of this name, or sources.
Result<std::vector<StructureIndex>> PathPlacer::find_members(const TreeLine& line, GroupId parent) {
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
    notes_.add(kUnusedLines,
               fmt::format("line {}, {}{}", line.number, in_quotes(line.member),
                           groups > 1 ? fmt::format(" (which is the name of {} groups)", groups) : ""));
  }
  placed_ += found.size();
  for (StructureIndex& index : found) index = parts_.place_source(index);
  return found;
}

}  // namespace splatlas

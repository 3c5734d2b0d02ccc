#include "player/window/session/structure_rows.h"

#include <algorithm>
#include <deque>
#include <sstream>
#include <utility>

namespace splatlas {
namespace {

/// Maximum number of rows after the initial expansion, level by level.
constexpr std::size_t kFewRows = 24;

/// Converts ASCII letters to lower case, and keeps all other bytes, such as UTF-8 sequences.
std::string to_lower(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return lower;
}

/// Hash of a path in the tree (SplitMix64). A collision of 64-bit hashes within an atlas is negligible.
std::uint64_t place_below(std::uint64_t parent, StructureIndex s) {
  std::uint64_t x = parent + 0x9e3779b97f4a7c15u * (std::uint64_t{s} + 1);
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

}  // namespace

StructureRows::StructureRows(const StructureGraph& graph) : graph_(graph) {
  std::size_t shown = graph.roots().size();
  std::deque<std::pair<StructureIndex, std::uint64_t>> level_by_level;
  for (const StructureIndex root : graph.roots()) level_by_level.emplace_back(root, place_below(0, root));
  for (; !level_by_level.empty(); level_by_level.pop_front()) {
    const auto [s, place] = level_by_level.front();
    shown += graph.children(s).size();
    if (shown > kFewRows) break;
    open_.insert(place);
    for (const StructureIndex child : graph.children(s)) {
      level_by_level.emplace_back(child, place_below(place, child));
    }
  }
  rebuild();
}

void StructureRows::toggle(const StructureRow& row) {
  if (searching() || !row.has_children) return;
  if (open_.erase(row.place) == 0) open_.insert(row.place);
  rebuild();
}

std::size_t StructureRows::reveal(StructureIndex s) {
  const auto row_of = [&](const auto& matches) {
    return static_cast<std::size_t>(std::find_if(rows_.begin(), rows_.end(), matches) - rows_.begin());
  };
  const auto shows_s = [&](const StructureRow& row) { return row.structure == s; };
  if (const std::size_t shown = row_of(shows_s); shown < rows_.size()) return shown;

  std::vector<StructureIndex> path{s};
  while (!graph_[path.back()].parents.empty()) path.push_back(graph_[path.back()].parents.front());
  std::uint64_t place = 0;
  for (auto step = path.rbegin(); step != path.rend(); ++step) {
    place = place_below(place, *step);
    if (*step != s) open_.insert(place);
  }
  search_.clear();
  words_.clear();
  rebuild();
  return row_of([&](const StructureRow& row) { return row.place == place; });
}

void StructureRows::search(std::string_view text) {
  search_ = text;
  words_.clear();
  std::istringstream words(to_lower(text));
  for (std::string word; words >> word;) words_.push_back(word);
  rebuild();
}

void StructureRows::rebuild() {
  rows_.clear();
  if (searching()) {
    list_found();
  } else {
    for (const StructureIndex root : graph_.roots()) list_branch(root, 0, 0);
  }
}

void StructureRows::list_branch(StructureIndex s, int depth, std::uint64_t parent_place) {
  const std::uint64_t place = place_below(parent_place, s);
  const auto children = graph_.children(s);
  const bool open = open_.contains(place);
  rows_.push_back({s, depth, !children.empty(), open, place});
  if (!open) return;
  for (const StructureIndex child : children) list_branch(child, depth + 1, place);
}

void StructureRows::list_found() {
  std::vector<StructureRow> others;
  for (const StructureIndex s : graph_.preorder()) {
    const std::string name = to_lower(graph_[s].name), id = to_lower(graph_[s].id);
    const bool found = std::all_of(words_.begin(), words_.end(), [&](const std::string& word) {
      return name.find(word) != std::string::npos || id.find(word) != std::string::npos;
    });
    if (!found) continue;
    const StructureRow row{s, 0, false, false, place_below(0, s)};
    (name.starts_with(words_.front()) ? rows_ : others).push_back(row);
  }
  rows_.insert(rows_.end(), others.begin(), others.end());
}

}  // namespace splatlas

// The rows of the structure tree on screen: open branches, or what a search finds.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

#include "format/structure_graph.h"

namespace splatlas {

struct StructureRow {
  StructureIndex structure = kNoStructure;
  int depth = 0;
  bool has_children = false;
  bool open = false;
  std::uint64_t place = 0;  ///< tells rows of one structure under different parents apart
};

/// A structure stands once under each of its parents, however these are reached. Only open branches have
/// rows, so that a graph with very many paths costs no more than what is looked at. Not for use by several
/// threads.
class StructureRows {
 public:
  /// Opens branches, level by level, as far as that gives few rows. `graph` must outlive the rows.
  explicit StructureRows(const StructureGraph& graph);

  [[nodiscard]] const std::vector<StructureRow>& rows() const { return rows_; }

  /// Opens or closes the branch below a row; nothing for a row of a search.
  void toggle(const StructureRow& row);
  /// Opens what leads to `s`, by first parents, ends a search that does not show it, and returns its row.
  std::size_t reveal(StructureIndex s);

  /// Words that must all occur in a structure's name or id, whatever their case. With any, rows() lists what
  /// is found, each structure once, names that begin with the text first; without, the tree again.
  void search(std::string_view text);
  [[nodiscard]] const std::string& search_text() const { return search_; }
  [[nodiscard]] bool searching() const { return !words_.empty(); }

 private:
  void rebuild();
  void list_branch(StructureIndex s, int depth, std::uint64_t parent_place);
  void list_found();

  const StructureGraph& graph_;
  std::unordered_set<std::uint64_t> open_;  // places
  std::string search_;
  std::vector<std::string> words_;  // of the search, in lower case
  std::vector<StructureRow> rows_;
};

}  // namespace splatlas

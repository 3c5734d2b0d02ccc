// Visible rows of the structure tree: open branches or search results.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

#include "format/content/structure_graph.h"

namespace splatlas {

/// Row of the tree.
struct StructureRow {
  StructureIndex structure = kNoStructure;
  int depth = 0;
  bool has_children = false;
  bool open = false;
  std::uint64_t place = 0;  ///< hash of the path from the root, distinct below different parents
};

/// A structure has a row below each of its parents. Only open branches have rows, so the cost depends on the
/// visible part of the graph, not on its number of paths. Not thread-safe.
class StructureRows {
 public:
  /// Opens branches level by level up to a small number of rows. `graph` must outlive the rows.
  explicit StructureRows(const StructureGraph& graph);

  [[nodiscard]] const std::vector<StructureRow>& rows() const { return rows_; }

  /// Opens or closes the branch below a row. No effect on search results.
  void toggle(const StructureRow& row);
  /// Opens the path of first parents to `s`, and returns its row. Ends a search that does not list `s`.
  std::size_t reveal(StructureIndex s);

  /// Lists structures whose name or id contains all words of the text, ignoring ASCII case. Prefix matches
  /// come first, and each structure once. Empty text returns to the tree.
  void search(std::string_view text);
  [[nodiscard]] const std::string& search_text() const { return search_; }
  [[nodiscard]] bool searching() const { return !words_.empty(); }

 private:
  void rebuild();
  void list_branch(StructureIndex s, int depth, std::uint64_t parent_place);
  void list_found();

  const StructureGraph& graph_;
  std::unordered_set<std::uint64_t> open_;  // places of open branches
  std::string search_;
  std::vector<std::string> words_;  // words of the search, in lower case
  std::vector<StructureRow> rows_;
};

}  // namespace splatlas

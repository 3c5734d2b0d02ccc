// Anatomical structures and how they contain one another.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "format/color.h"
#include "format/result.h"

namespace splatlas {

using StructureIndex = std::uint32_t;
inline constexpr StructureIndex kNoStructure = 0xffffffffu;

/// Limits that keep a stranger's graph from costing more than its bytes.
inline constexpr std::size_t kMaxStructures = 1u << 20;
inline constexpr std::size_t kMaxGraphDepth = 256;

/// An anatomical entity. A structure with a label, a segmentation or a surface file of its own holds voxels
/// or triangles; a structure without is a group: it stands for its descendants.
struct Structure {
  std::string id;  ///< stable, unique in the atlas without regard to case; letters, digits, "_", "-", "."
  std::string name = {};  ///< as shown; need not be unique
  Rgb color = {};
  std::optional<std::int64_t> label =
      std::nullopt;                          ///< its value in the source label map, if it came from one
  std::vector<StructureIndex> parents = {};  ///< several allowed: one gyrus belongs to a side and to a lobe
  bool external = false;  ///< its surface came from a file of its own (an implant, a needle)

  friend bool operator==(const Structure&, const Structure&) = default;
};

/// A directed acyclic graph of structures. Immutable once built; safe to share between threads.
class StructureGraph {
 public:
  StructureGraph() = default;

  /// Refuses (kInvalidAtlas) empty, malformed or repeated ids, parents that do not exist or repeat, cycles, a
  /// depth above kMaxGraphDepth and more than kMaxStructures structures. Cost: linear in structures and
  /// parents.
  [[nodiscard]] static Result<StructureGraph> build(std::vector<Structure> structures);

  [[nodiscard]] std::size_t size() const { return structures_.size(); }
  [[nodiscard]] const Structure& operator[](StructureIndex s) const { return structures_[s]; }
  [[nodiscard]] std::span<const Structure> structures() const { return structures_; }
  [[nodiscard]] std::span<const StructureIndex> children(StructureIndex s) const;
  [[nodiscard]] std::span<const StructureIndex> roots() const { return roots_; }
  /// Every structure once, parents' first visit before children: the order in which streams are stored, so
  /// that a subtree of the first hierarchy is one contiguous range.
  [[nodiscard]] std::span<const StructureIndex> preorder() const { return preorder_; }
  /// Every structure once, all its parents before it; roots first.
  [[nodiscard]] std::span<const StructureIndex> topological() const { return topological_; }
  /// `s` and everything below it, each once, in the preorder of a walk that starts at `s`. Cost: linear in
  /// what it returns and the parents of that.
  [[nodiscard]] std::vector<StructureIndex> descendants(StructureIndex s) const;
  /// One path per way from a root, names joined by "/"; at most `limit` of them, by first parents first.
  [[nodiscard]] std::vector<std::string> paths(StructureIndex s, std::size_t limit = 64) const;

 private:
  void list_children();
  [[nodiscard]] Result<void> sort_topologically();
  template <typename IsNew>
  [[nodiscard]] std::vector<StructureIndex> walk(std::span<const StructureIndex> starts,
                                                 const IsNew& is_new) const;

  std::vector<Structure> structures_;
  std::vector<std::uint32_t> first_child_;  // size + 1 offsets into children_
  std::vector<StructureIndex> children_;
  std::vector<StructureIndex> roots_;
  std::vector<StructureIndex> preorder_;
  std::vector<StructureIndex> topological_;
};

/// A stable id from a display name: ASCII letters and digits kept, all between them one "_" ("Left
/// hemisphere" becomes "Left_hemisphere"); "structure" when nothing is left. Not made unique.
[[nodiscard]] std::string id_from_name(std::string_view name);

}  // namespace splatlas

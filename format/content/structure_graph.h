// Directed acyclic graph of anatomical structures.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "format/content/color.h"
#include "format/result.h"

namespace splatlas {

using StructureIndex = std::uint32_t;
inline constexpr StructureIndex kNoStructure = 0xffffffffu;

/// Limits that bound the cost of untrusted graphs.
inline constexpr std::size_t kMaxStructures = 1u << 20;
inline constexpr std::size_t kMaxGraphDepth = 256;

/// A name or code of a structure in another vocabulary: {"SNOMED", "64033007"}, {"de", "Niere"}.
struct Term {
  std::string vocabulary, value;

  friend bool operator==(const Term&, const Term&) = default;
};

/// An anatomical structure, or a group without own voxels and triangles that represents its descendants.
struct Structure {
  std::string id;         ///< stable and unique, ignoring case; letters, digits, "_", "-" and "."
  std::string name = {};  ///< display name; may be ambiguous
  Rgb color = {};
  std::optional<std::int64_t> label = std::nullopt;  ///< value in the source label map, if any
  std::vector<StructureIndex> parents =
      {};                 ///< may be several: a gyrus belongs to a hemisphere and to a lobe
  bool external = false;  ///< surface from a mesh file (an implant, a needle)
  std::vector<Term> terms = {};

  friend bool operator==(const Structure&, const Structure&) = default;
};

/// A directed acyclic graph of structures. Immutable and thread-safe.
class StructureGraph {
 public:
  StructureGraph() = default;

  /// Builds and validates the graph. kInvalidAtlas for empty, malformed or duplicate ids, missing or
  /// duplicate parents, cycles, a depth above kMaxGraphDepth, and more than kMaxStructures structures. Cost:
  /// linear in structures and parents.
  [[nodiscard]] static Result<StructureGraph> build(std::vector<Structure> structures);

  [[nodiscard]] std::size_t size() const { return structures_.size(); }
  [[nodiscard]] const Structure& operator[](StructureIndex s) const { return structures_[s]; }
  [[nodiscard]] std::span<const Structure> structures() const { return structures_; }
  [[nodiscard]] std::span<const StructureIndex> children(StructureIndex s) const;
  [[nodiscard]] std::span<const StructureIndex> roots() const { return roots_; }
  /// Depth-first preorder from the roots, each structure once. Streams are stored in this order, so that a
  /// subtree of the first hierarchy is contiguous.
  [[nodiscard]] std::span<const StructureIndex> preorder() const { return preorder_; }
  /// Topological order: roots first, every structure after all its parents.
  [[nodiscard]] std::span<const StructureIndex> topological() const { return topological_; }
  /// `s` and its descendants, each once, in depth-first preorder from `s`. Linear in these and their edges.
  [[nodiscard]] std::vector<StructureIndex> descendants(StructureIndex s) const;
  /// The same for several structures together: each structure is visited once.
  [[nodiscard]] std::vector<StructureIndex> descendants(std::span<const StructureIndex> structures) const;
  /// Paths of names from the roots to `s`, joined by "/"; at most `limit`, in the order of parents.
  [[nodiscard]] std::vector<std::string> paths(StructureIndex s, std::size_t limit = 64) const;

  /// The structures of an id, name, path, term or wildcard pattern, without descendants, in index order. Ids
  /// take precedence over names, names over paths, paths over terms. A path may start at any structure
  /// ("Cerebellum/Left"). A wildcard pattern matches ids, names and paths; if none fits, terms. kNotFound if
  /// nothing matches, or if a name, path or term without a wildcard is ambiguous. The message lists the
  /// nearest names, or the candidates' paths and ids. Throws as check_task(). Cost: linear in the structures,
  /// their parents and the total length of names and terms, times the length of a pattern (at most 256).
  [[nodiscard]] Result<std::vector<StructureIndex>> find(std::string_view name) const;
  /// The structure with a value in the source label map. kNotFound if there is
  /// none, and if it is ambiguous. Cost: linear in the structures.
  [[nodiscard]] Result<StructureIndex> find_label(std::int64_t label) const;
  /// The structures of a NAME or a label of the selection language, as "Left cerebrum" or #17. Quotes are
  /// optional here: text that begins neither with a quote nor with "#" is the name as it is. kUsage for a
  /// quote that is never closed, for text behind the closing one, and for "#" without a whole number.
  [[nodiscard]] Result<std::vector<StructureIndex>> find_named(std::string_view text) const;

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

/// Derives an id from a display name: replaces other characters between ASCII letters and digits by one "_"
/// ("Left hemisphere" becomes "Left_hemisphere"). "structure" if nothing remains. The id may not be unique.
[[nodiscard]] std::string id_from_name(std::string_view name);

}  // namespace splatlas

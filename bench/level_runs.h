// One run model per level of the tree: the paper's other proposal (section 3: "several RL could be created,
// associated to the intermediate nodes of the RDT and traversed simultaneously").
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "bench/run_collector.h"
#include "format/atlas_reader.h"

namespace splatlas {

/// For every structure, the runs of all that it and its descendants hold, along each axis: a level of the
/// graph is the lists of its structures, which may overlap where structures have several parents. The
/// classes' own lists, which tell interior from boundary, are the lowest level. The higher the level, the
/// fewer and longer the runs. Immutable.
class LevelRuns {
 public:
  /// Reads the runs of every class. Cost: of each run once per structure above it, sorted.
  [[nodiscard]] static Result<LevelRuns> build(const Atlas& atlas);

  /// Adds the runs of every class with a draw: from the lists of the highest structures below which all is
  /// drawn alike, and from those of classes where no structure is. Overlapping lists are added each.
  /// `draw_of_class` is one of draws_by_class(), best one with shared draws. Cost: runs of the lists that are
  /// taken, and the classes below structures that are looked at.
  void collect(std::span<const std::uint32_t> draw_of_class, Axis axis, RunCollector& runs) const;

  /// Of all lists along an axis, those of classes included.
  [[nodiscard]] std::uint64_t runs(Axis axis) const;
  /// The lists along an axis, as an atlas file codes run lists.
  [[nodiscard]] std::vector<std::byte> encoded(Axis axis) const;

 private:
  /// What is taken for one selection.
  struct Cover {
    std::vector<std::pair<StructureIndex, std::uint32_t>> structures;  ///< with their draws
    std::vector<ClassId> classes;
  };
  [[nodiscard]] Cover cover(std::span<const std::uint32_t> draw_of_class) const;

  std::vector<StructureIndex> topological_;
  std::vector<std::vector<ClassId>> classes_below_;                // per structure: those it holds, ascending
  std::array<std::vector<ClassRuns>, 3> of_class_, of_structure_;  // per axis
  Index3 size_{};
};

}  // namespace splatlas

// Run models per level of the tree, the other proposal of the paper (section 3: "several RL could be created,
// associated to the intermediate nodes of the RDT and traversed simultaneously").
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "bench/experiments/run_collector.h"
#include "format/atlas_reader.h"

namespace splatlas {

/// For every structure, the runs of all its voxels and those of its descendants, along each axis. Lists may
/// overlap if structures have several parents. The lists of classes, which separate interior from boundary,
/// form the lowest level. Higher levels have fewer and longer runs. Immutable.
class LevelRuns {
 public:
  /// Reads the runs of every class. Cost: each run once per structure above it, sorted.
  [[nodiscard]] static Result<LevelRuns> build(const Atlas& atlas);

  /// Adds the runs of every class with a draw: from the lists of the highest structures with a single draw,
  /// and of single classes elsewhere. Overlapping lists are all added. `draw_of_class` comes from
  /// draws_by_class(), preferably with shared draws. Cost: runs of the lists taken, and classes below the
  /// structures visited.
  void collect(std::span<const std::uint32_t> draw_of_class, Axis axis, RunCollector& runs) const;

  /// Runs of all lists along an axis, those of classes included.
  [[nodiscard]] std::uint64_t runs(Axis axis) const;
  /// The lists along an axis, in the run encoding of atlas files.
  [[nodiscard]] std::vector<std::byte> encoded(Axis axis) const;

 private:
  /// Lists that cover one selection.
  struct Cover {
    std::vector<std::pair<StructureIndex, std::uint32_t>> structures;  ///< with their draws
    std::vector<ClassId> classes;
  };
  [[nodiscard]] Cover cover(std::span<const std::uint32_t> draw_of_class) const;

  std::vector<StructureIndex> topological_;
  std::vector<std::vector<ClassId>> classes_below_;                // per structure, ascending
  std::array<std::vector<ClassRuns>, 3> of_class_, of_structure_;  // per axis
  Index3 size_{};
};

}  // namespace splatlas

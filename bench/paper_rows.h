// Our numbers beside the paper's, row by row.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "bench/bench.h"
#include "bench/paper_tables.h"
#include "bench/traversal_cost.h"

namespace splatlas {

/// Tables 1 and 3: interior voxels, boundary voxels and triangles of every region.
[[nodiscard]] Result<Table> region_table(const Atlas& atlas, std::span<const paper::Region> regions,
                                         const std::string& name, const std::string& title);

/// What add_traversal_tables measures.
struct TraversalTable {
  std::string name, title;
  std::span<const paper::Traversal> rows;
  std::uint64_t paper_voxels = 0;  ///< that the paper's occupancy is relative to
  std::span<const Figure> figures;
};

/// Tables 2 and 4: measures every row's figure with one thread and with two, and adds to the report
///   - a table of counts, occupancy and cost ratios beside the paper's,
///   - a table of what the stages take ("NAME stages"),
///   - cost_ratio_FIGURE and occupancy_FIGURE to the summary,
///   - a failure for every figure whose pictures differ from full traversal's.
/// The cost ratio is CPU time with one thread, of a frame of the turning model.
[[nodiscard]] Result<void> add_traversal_tables(const std::shared_ptr<const Atlas>& atlas,
                                                const TraversalTable& table, const BenchOptions& options,
                                                Report& report);

}  // namespace splatlas

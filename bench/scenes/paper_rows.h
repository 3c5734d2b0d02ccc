// Our numbers beside those of the paper, row by row.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "bench/bench.h"
#include "bench/scenes/gallery.h"
#include "bench/scenes/paper_tables.h"
#include "format/atlas_reader.h"

namespace splatlas {

/// Tables 1 and 3: interior voxels, boundary voxels and triangles of every region.
[[nodiscard]] Result<Table> region_table(const Atlas& atlas, std::span<const paper::Region> regions,
                                         const std::string& name, const std::string& title);

/// Inputs of add_traversal_tables().
struct TraversalTable {
  std::string name, title;
  std::span<const paper::Traversal> rows;
  std::uint64_t paper_voxels = 0;  ///< denominator of the occupancy in the paper
  std::span<const Figure> figures;
};

/// Tables 2 and 4: measures the figure of every row with one and two threads, and adds to the report
///   - a table of counts, occupancy and cost ratios beside the paper,
///   - a table of stage times ("NAME stages"),
///   - cost_ratio_FIGURE and occupancy_FIGURE to the summary,
///   - a failure for every figure whose pictures differ from those of full traversal.
/// Figures are drawn at 512x512, with everything decoded in advance. The cost ratio is CPU time of one
/// thread, for a frame of the turning model.
[[nodiscard]] Result<void> add_traversal_tables(const std::shared_ptr<const Atlas>& atlas,
                                                const TraversalTable& table, const BenchOptions& options,
                                                Report& report);

}  // namespace splatlas

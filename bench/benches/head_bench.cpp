// Bench `head`: tables 3 and 4 of the paper, on the Colin 27 head with AAL labels.
#include <fmt/format.h>

#include "bench/bench.h"
#include "bench/scenes/atlases.h"
#include "bench/scenes/cut_rows.h"
#include "bench/scenes/paper_rows.h"
#include "format/result_macros.h"

namespace splatlas {

Result<Report> run_head_bench(const BenchOptions& options) {
  Report report;
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<Figure> figures, read_gallery("colin27"));
  SPLATLAS_ASSIGN_OR_RETURN(const std::shared_ptr<const Atlas> atlas, open_colin27(options));
  SPLATLAS_ASSIGN_OR_RETURN(Table table_3, region_table(*atlas, paper::kTable3, "3", "Table 3: the head"));
  const Index3& size = atlas->grid().size;
  table_3.notes = {
      fmt::format("ours: {}x{}x{} voxels; AAL divides a cerebrum into gyri, each with a surface of its own",
                  size[0], size[1], size[2]),
      "the paper's: 190x220x178 voxels"};
  report.tables.push_back(std::move(table_3));
  const TraversalTable table_4{"4", "Table 4: traversals of the head, 512x512", paper::kTable4,
                               paper::kHeadVoxels, figures};
  SPLATLAS_RETURN_IF_ERROR(add_traversal_tables(atlas, table_4, options, report));
  SPLATLAS_RETURN_IF_ERROR(add_cut_table(atlas, options, report));
  return report;
}

}  // namespace splatlas

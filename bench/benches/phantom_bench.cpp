// Bench `phantom`: tables 1 and 2 of the paper.
#include <fmt/format.h>

#include "bench/bench.h"
#include "bench/scenes/atlases.h"
#include "bench/scenes/paper_rows.h"
#include "format/result_macros.h"

namespace splatlas {
namespace {

/// The phantom is exact: any other number than that of the paper is a failure.
void expect(const std::string& what, std::uint64_t ours, std::uint64_t papers, Report& report) {
  if (ours != papers) report.failures.push_back(fmt::format("{}: {}, must be {}", what, ours, papers));
}

void add_table_1(const Atlas& atlas, Table table, Report& report) {
  for (std::size_t n = 0; n < table.rows.size(); ++n) {
    const Row& row = table.rows[n];
    for (const char* what : {"interior", "boundary", "triangles"}) {
      const std::string key = fmt::format("{}_{}", what, n + 1);
      report.summary[key] = row[what];
      expect(key, row[what].get<std::uint64_t>(), row[fmt::format("paper_{}", what)].get<std::uint64_t>(),
             report);
    }
  }
  const std::uint64_t empty = atlas.classes().voxels(kEmptyClass);
  table.notes.push_back(fmt::format("empty voxels: {}, in the paper {}", empty, paper::kPhantomEmpty));
  report.summary["empty"] = empty;
  expect("empty", empty, paper::kPhantomEmpty, report);
  report.tables.push_back(std::move(table));
}

void check_table_2(const Table& table, Report& report) {
  for (std::size_t n = 0; n < paper::kTable2.size(); ++n) {
    const paper::Traversal& papers = paper::kTable2[n];
    const Row& row = table.rows[n];
    const auto check = [&](const char* key, std::uint64_t expected) {
      expect(fmt::format("figure {}: {}", papers.figure, key), row[key].get<std::uint64_t>(), expected,
             report);
    };
    check("k_vol", papers.volume);
    check("k_sur", papers.surface);
    check("k_hyb", papers.hybrid);
  }
}

}  // namespace

Result<Report> run_phantom_bench(const BenchOptions& options) {
  Report report;
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<Figure> figures, read_gallery("phantom"));
  SPLATLAS_ASSIGN_OR_RETURN(const std::shared_ptr<const Atlas> atlas, open_phantom(options));
  SPLATLAS_ASSIGN_OR_RETURN(Table table_1, region_table(*atlas, paper::kTable1, "1", "Table 1: the phantom"));
  add_table_1(*atlas, std::move(table_1), report);
  const TraversalTable table_2{"2", "Table 2: traversals of the phantom, 512x512", paper::kTable2,
                               paper::kPhantomVoxels, figures};
  SPLATLAS_RETURN_IF_ERROR(add_traversal_tables(atlas, table_2, options, report));
  check_table_2(report.tables[1], report);
  return report;
}

}  // namespace splatlas

// Bench `size`: bytes of whole atlases against their parts, of sections, and of reads of single structures.
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "bench/bench.h"
#include "bench/measure/frames.h"
#include "bench/measure/measure.h"
#include "bench/scenes/atlases.h"
#include "format/content/selection.h"
#include "format/result_macros.h"
#include "player/renderer.h"
#include "tests/support/page_residency.h"
#include "tests/support/temporary_folder.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

/// The 116 surfaces, smoothed and without normals, by Draco 1.5 at 11 bits: 1.36 M triangles, measured once.
constexpr std::uint64_t kAnchorSurfaceBytes = 1299047;

/// Draws the volume of each structure from an evicted copy of a file, then counts its resident pages. Pages
/// of the file itself stay in memory: open atlases map it.
Result<Table> measure_reading(const Atlas& listed, const fs::path& file, const BenchOptions& options,
                              nlohmann::ordered_json& summary) {
  Table table{"reading",
              "Pages of the file in memory after the volume of one structure was drawn, none before",
              {"by mincore; bytes_asked: of header, directory and chunks; the largest first"}};
  options.tell("reading structures one by one");
  const fs::path copy = file.string() + ".copy";
  std::error_code error;
  if (!fs::copy_file(file, copy, error))
    return fail(ErrorCode::kFailed, "{}: cannot be copied: {}", file.string(), error.message());
  const auto bytes = static_cast<double>(listed.counters().file);
  std::vector<double> fractions;
  for (StructureIndex s = 0; s < listed.graph().size(); s += options.quick ? 8 : 1) {
    if (listed.graph()[s].label == std::nullopt) continue;
    SPLATLAS_RETURN_IF_ERROR(evict(copy));
    SPLATLAS_ASSIGN_OR_RETURN(const auto atlas, Atlas::open(copy));
    Renderer renderer(atlas, RendererOptions{.threads = 1});
    Selection selection;
    selection.structures.resize(atlas->graph().size());
    selection.structures[s].mode = DrawMode::kVolume;
    SPLATLAS_RETURN_IF_ERROR(renderer.select(selection));
    SPLATLAS_RETURN_IF_ERROR(renderer.render(oblique_camera(), {.hybrid_shading = false}));
    SPLATLAS_ASSIGN_OR_RETURN(const std::uint64_t resident, resident_bytes(copy));
    fractions.push_back(static_cast<double>(resident) / bytes);
    table.rows.push_back({{"structure", atlas->graph()[s].id},
                          {"bytes_asked", atlas->counters().read},
                          {"bytes_resident", resident},
                          {"fraction", fractions.back()}});
  }
  std::stable_sort(table.rows.begin(), table.rows.end(),
                   [](const Row& a, const Row& b) { return a["bytes_resident"] > b["bytes_resident"]; });
  summary["one_structure_read_median"] = median(fractions);
  summary["one_structure_read_max"] = *std::ranges::max_element(fractions);
  return table;
}

}  // namespace

Result<Report> run_size_bench(const BenchOptions& options) {
  Report report;
  const SourceFiles sources = aal_sources();
  const TemporaryFolder folder;
  options.tell("building the atlases of Colin 27 with AAL");
  const fs::path file = folder.path() / "full.atlas";
  const fs::path compact_file = folder.path() / "compact.atlas";
  SPLATLAS_RETURN_IF_ERROR(build_file(sources, file));
  SPLATLAS_RETURN_IF_ERROR(build_file(sources, compact_file, true));
  SPLATLAS_ASSIGN_OR_RETURN(const auto full, Atlas::open(file));
  SPLATLAS_ASSIGN_OR_RETURN(const auto compact, Atlas::open(compact_file));
  std::error_code error;
  const auto parts = static_cast<double>(fs::file_size(sources.volume, error) +
                                         fs::file_size(sources.labels, error) + kAnchorSurfaceBytes);
  report.summary["atlas_vs_parts"] = static_cast<double>(full->counters().file) / parts;
  report.summary["compact_vs_parts"] = static_cast<double>(compact->counters().file) / parts;
  std::uint64_t runs = 0;
  for (const SectionSize& section : full->sections()) {
    if (section.name.starts_with("runs_")) runs += section.bytes;
  }
  report.summary["runs_bytes_per_voxel"] =
      static_cast<double>(runs) / static_cast<double>(full->grid().voxels());
  SPLATLAS_ASSIGN_OR_RETURN(report.tables.emplace_back(),
                            measure_reading(*full, file, options, report.summary));
  return report;
}

}  // namespace splatlas

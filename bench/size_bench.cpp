// Bench `size`: bytes against peers: whole atlases, their sections, the label partition, reads of single
// structures, and full decoding.
#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "bench/atlases.h"
#include "bench/bench.h"
#include "bench/decoding.h"
#include "bench/frames.h"
#include "bench/measure.h"
#include "bench/page_residency.h"
#include "bench/scratch_folder.h"
#include "format/selection.h"
#include "player/render_frame.h"
#include "preprocess/build_atlas.h"
#ifdef SPLATLAS_HAS_DRACO
#include "bench/peers/draco_peer.h"
#include "format/system/result_macros.h"
#endif

namespace splatlas {
namespace {

namespace fs = std::filesystem;

/// The same parts with smoothed surfaces, measured separately with Draco 1.5: 1.36 M triangles, 11 bits.
constexpr std::uint64_t kAnchorSurfaceBytes = 1299047;

/// Label maps, and their size by crackle (best variant, then Zstandard 19), measured separately.
struct LabelMap {
  const char* file;
  std::uint64_t crackle_bytes;
};
constexpr std::array kLabelMaps{LabelMap{"aal.nii.gz", 52218}, LabelMap{"brodmann.nii.gz", 70211},
                                LabelMap{"inia19-NeuroMaps.nii.gz", 93639}};

Result<std::shared_ptr<const Atlas>> build(const fs::path& output, const SourceFiles& sources, bool compact) {
  BuildOptions build;
  build.sources = sources;
  build.tool = "splatlas-bench";
  build.output = output;
  build.compact = compact;
  SPLATLAS_RETURN_IF_ERROR(build_atlas(build));
  return Atlas::open(output);
}

std::uint64_t bytes_of_section(const Atlas& atlas, std::string_view name) {
  for (const SectionSize& section : atlas.sections()) {
    if (section.name == name) return section.bytes;
  }
  return 0;
}

Table section_table(const Atlas& full, const Atlas& compact) {
  Table table{"sections", "Bytes per section of Colin 27 with AAL: everything stored, and --compact", {}, {}};
  const auto voxels = static_cast<double>(full.grid().voxels());
  for (const SectionSize& section : full.sections()) {
    table.rows.push_back({{"section", section.name},
                          {"bytes", section.bytes},
                          {"per_voxel", static_cast<double>(section.bytes) / voxels},
                          {"compact_bytes", bytes_of_section(compact, section.name)}});
  }
  table.rows.push_back({{"section", "file"},
                        {"bytes", full.counters().file},
                        {"per_voxel", static_cast<double>(full.counters().file) / voxels},
                        {"compact_bytes", compact.counters().file}});
  return table;
}

#ifdef SPLATLAS_HAS_DRACO
Result<std::uint64_t> draco_bytes(const Atlas& atlas, int normal_bits) {
  std::uint64_t sum = 0;
  for (StructureIndex s = 0; s < atlas.graph().size(); ++s) {
    SPLATLAS_ASSIGN_OR_RETURN(const SurfaceMesh mesh, atlas.read_surface(s));
    SPLATLAS_ASSIGN_OR_RETURN(const std::vector<std::byte> encoded,
                              draco_peer::encode(mesh, {.position_bits = 11, .normal_bits = normal_bits}));
    sum += encoded.size();
  }
  return sum;
}
#endif

/// The same content in common exchange files, with several variants of surfaces.
Result<Table> compare_with_parts(const Atlas& full, const Atlas& compact, nlohmann::ordered_json& summary) {
  Table table{
      "parts",
      "Colin 27 with AAL against its parts: volume and labels as .nii.gz, 116 surfaces by Draco",
      {"smoothed: surfaces smoothed, without normals, as measured elsewhere with Draco 1.5; the others are "
       "those of the atlas, which has their normals"},
      {}};
  std::error_code error;
  const std::uint64_t images = fs::file_size(templates_folder() / "ch2.nii.gz", error) +
                               fs::file_size(templates_folder() / "aal.nii.gz", error);
  const auto add = [&](const char* surfaces, std::uint64_t bytes) {
    const auto parts = static_cast<double>(images + bytes);
    table.rows.push_back({{"surfaces", surfaces},
                          {"surface_bytes", bytes},
                          {"parts_bytes", images + bytes},
                          {"atlas", static_cast<double>(full.counters().file) / parts},
                          {"compact", static_cast<double>(compact.counters().file) / parts}});
  };
  add("Draco 11 bit, smoothed", kAnchorSurfaceBytes);
#ifdef SPLATLAS_HAS_DRACO
  SPLATLAS_ASSIGN_OR_RETURN(const std::uint64_t with_normals, draco_bytes(full, 8));
  SPLATLAS_ASSIGN_OR_RETURN(const std::uint64_t without, draco_bytes(full, 0));
  add("Draco 11 bit, normals 8 bit", with_normals);
  add("Draco 11 bit, without normals", without);
#endif
  summary["atlas_vs_parts"] = table.rows[0]["atlas"];
  summary["compact_vs_parts"] = table.rows[0]["compact"];
  if (table.rows.size() > 1) {
    summary["atlas_vs_own_parts"] = table.rows[1]["atlas"];
    summary["compact_vs_own_parts"] = table.rows[1]["compact"];
  }
  return table;
}

/// Atlases of labels alone.
Result<Table> measure_labels(const fs::path& folder, const BenchOptions& options,
                             nlohmann::ordered_json& summary) {
  Table table{
      "labels",
      "The label partition of a compact atlas against crackle with Zstandard, the best label codec",
      {"runs_bytes: runs_z, from which all else of the partition is derived; crackle: measured elsewhere"},
      {}};
  for (const LabelMap& map : kLabelMaps) {
    options.tell(fmt::format("building the atlas of {}", map.file));
    SourceFiles sources;
    sources.labels = templates_folder() / map.file;
    SPLATLAS_ASSIGN_OR_RETURN(const auto atlas, build(folder / "labels.atlas", sources, true));
    const std::uint64_t runs = bytes_of_section(*atlas, "runs_z");
    const double ratio = static_cast<double>(runs) / static_cast<double>(map.crackle_bytes);
    table.rows.push_back({{"labels", map.file},
                          {"structures", atlas->graph().size()},
                          {"runs", atlas->runs(Axis::kZ)},
                          {"runs_bytes", runs},
                          {"directory_bytes", bytes_of_section(*atlas, "directory")},
                          {"crackle_bytes", map.crackle_bytes},
                          {"runs_vs_crackle", ratio}});
    raise(summary, "labels_vs_crackle_max", ratio);
  }
  return table;
}

/// Draws the volume of each structure from an evicted file, then counts its resident pages.
Result<Table> measure_reading(const fs::path& file, const BenchOptions& options,
                              nlohmann::ordered_json& summary) {
  Table table{"reading",
              "Pages of the file in memory after the volume of one structure was drawn, none before",
              {"by mincore; bytes_asked: of header, directory and chunks; the largest first"},
              {}};
  options.tell("reading structures one by one");
  SPLATLAS_ASSIGN_OR_RETURN(const auto listed, Atlas::open(file));
  const auto bytes = static_cast<double>(listed->counters().file);
  std::vector<double> fractions;
  for (StructureIndex s = 0; s < listed->graph().size(); s += options.quick ? 8 : 1) {
    if (listed->graph()[s].label == std::nullopt) continue;
    SPLATLAS_RETURN_IF_ERROR(evict(file));
    SPLATLAS_ASSIGN_OR_RETURN(const auto atlas, Atlas::open(file));
    Renderer renderer(atlas, RendererOptions{.threads = 1});
    Selection selection;
    selection.structures.resize(atlas->graph().size());
    selection.structures[s].mode = DrawMode::kVolume;
    SPLATLAS_RETURN_IF_ERROR(renderer.select(selection));
    RenderOptions render;
    render.hybrid_shading = false;
    Picture picture;
    SPLATLAS_RETURN_IF_ERROR(renderer.render(oblique_camera(), render, picture));
    SPLATLAS_ASSIGN_OR_RETURN(const std::uint64_t resident, resident_bytes(file));
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
  SPLATLAS_ASSIGN_OR_RETURN(const SourceFiles sources, aal_sources());
  SPLATLAS_ASSIGN_OR_RETURN(const ScratchFolder folder, ScratchFolder::make());
  options.tell("building the atlases of Colin 27 with AAL");
  const fs::path file = folder.path() / "full.atlas";
  SPLATLAS_ASSIGN_OR_RETURN(const auto full, build(file, sources, false));
  SPLATLAS_ASSIGN_OR_RETURN(const auto compact, build(folder.path() / "compact.atlas", sources, true));
  report.tables.push_back(section_table(*full, *compact));
  options.tell("coding the surfaces as others do");
  SPLATLAS_ASSIGN_OR_RETURN(Table parts, compare_with_parts(*full, *compact, report.summary));
  report.tables.push_back(std::move(parts));
  std::uint64_t runs = 0;
  for (const char* section : {"runs_x", "runs_y", "runs_z"}) runs += bytes_of_section(*full, section);
  report.summary["runs_bytes_per_voxel"] =
      static_cast<double>(runs) / static_cast<double>(full->grid().voxels());
  SPLATLAS_ASSIGN_OR_RETURN(Table labels, measure_labels(folder.path(), options, report.summary));
  report.tables.push_back(std::move(labels));
  SPLATLAS_ASSIGN_OR_RETURN(Table reading, measure_reading(file, options, report.summary));
  report.tables.push_back(std::move(reading));
  SPLATLAS_ASSIGN_OR_RETURN(Table decoding, measure_decoding(file, options, report.summary));
  report.tables.push_back(std::move(decoding));
  return report;
}

}  // namespace splatlas

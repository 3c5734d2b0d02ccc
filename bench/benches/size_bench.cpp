// Bench `size`: bytes against peers: whole atlases, their sections, reads of single structures, and full
// decoding.
#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <zlib.h>

#include "bench/bench.h"
#include "bench/measure/frames.h"
#include "bench/measure/measure.h"
#include "bench/scenes/atlases.h"
#include "format/content/selection.h"
#include "format/result_macros.h"
#include "player/renderer.h"
#include "preprocess/build/build_atlas.h"
#include "tests/support/page_residency.h"
#include "tests/support/temporary_folder.h"
#ifdef SPLATLAS_HAS_DRACO
#include "bench/peers/draco_peer.h"
#endif

namespace splatlas {
namespace {

namespace fs = std::filesystem;

/// The same parts with smoothed surfaces, measured separately with Draco 1.5: 1.36 M triangles, 11 bits.
constexpr std::uint64_t kAnchorSurfaceBytes = 1299047;

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
  Table table{"sections", "Bytes per section of Colin 27 with AAL: everything stored, and --compact"};
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

/// Draco files of the surfaces; none without Draco.
using DracoFiles = std::vector<std::vector<std::byte>>;

Result<DracoFiles> draco_files([[maybe_unused]] const Atlas& atlas) {
  DracoFiles files;
#ifdef SPLATLAS_HAS_DRACO
  for (StructureIndex s = 0; s < atlas.graph().size(); ++s) {
    SPLATLAS_ASSIGN_OR_RETURN(const SurfaceMesh mesh, atlas.read_surface(s));
    SPLATLAS_ASSIGN_OR_RETURN(files.emplace_back(),
                              draco_peer::encode(mesh, {.position_bits = 11, .normal_bits = 8}));
  }
#endif
  return files;
}

/// The same content in common exchange files.
Table compare_with_parts(const Atlas& full, const Atlas& compact, nlohmann::ordered_json& summary) {
  Table table{"parts",
              "Colin 27 with AAL against its parts: volume and labels as .nii.gz, 116 surfaces by Draco",
              {"surfaces smoothed, without normals, as measured elsewhere with Draco 1.5"}};
  std::error_code error;
  const std::uint64_t images = fs::file_size(templates_folder() / "ch2.nii.gz", error) +
                               fs::file_size(templates_folder() / "aal.nii.gz", error);
  const auto parts = static_cast<double>(images + kAnchorSurfaceBytes);
  table.rows.push_back({{"surface_bytes", kAnchorSurfaceBytes},
                        {"parts_bytes", images + kAnchorSurfaceBytes},
                        {"atlas", static_cast<double>(full.counters().file) / parts},
                        {"compact", static_cast<double>(compact.counters().file) / parts}});
  summary["atlas_vs_parts"] = table.rows[0]["atlas"];
  summary["compact_vs_parts"] = table.rows[0]["compact"];
  return table;
}

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

enum Part : std::size_t { kLabels, kValues, kSurfaces, kNormals, kAllParts };
constexpr std::array kPartNames{"labels", "values", "surfaces", "normals at boundaries"};

/// Part by part, as in read_all().
Result<std::vector<Elapsed>> decode_atlas(const fs::path& file) {
  std::vector<Elapsed> parts(kAllParts);
  Stopwatch watch;
  SPLATLAS_ASSIGN_OR_RETURN(const auto atlas, Atlas::open(file));
  SPLATLAS_ASSIGN_OR_RETURN(const AtlasContent content, atlas->read_classes());
  parts[kLabels] = watch.lap();
  SPLATLAS_ASSIGN_OR_RETURN(const VoxelBuffer values, atlas->read_value_volume(content.class_volume));
  parts[kValues] = watch.lap();
  for (StructureIndex s = 0; s < atlas->graph().size(); ++s) SPLATLAS_RETURN_IF_ERROR(atlas->read_surface(s));
  parts[kSurfaces] = watch.lap();
  for (ClassId c = 0; c < atlas->classes().size(); ++c) SPLATLAS_RETURN_IF_ERROR(atlas->read_normals(c));
  parts[kNormals] = watch.lap();
  return parts;
}

Result<void> gunzip(const fs::path& path) {
  const std::unique_ptr<gzFile_s, int (*)(gzFile)> file(::gzopen(path.c_str(), "rb"), ::gzclose);
  std::vector<std::byte> bytes(std::size_t{1} << 20);
  int count = file == nullptr ? -1 : 1;
  while (count > 0) count = ::gzread(file.get(), bytes.data(), static_cast<unsigned>(bytes.size()));
  if (count < 0) return fail(ErrorCode::kFailed, path.string() + ": cannot be read by zlib");
  return {};
}

Result<std::vector<Elapsed>> decode_parts(const SourceFiles& sources,
                                          [[maybe_unused]] const DracoFiles& surfaces,
                                          [[maybe_unused]] const Atlas& atlas) {
  std::vector<Elapsed> parts(kAllParts);
  Stopwatch watch;
  SPLATLAS_RETURN_IF_ERROR(gunzip(sources.labels));
  parts[kLabels] = watch.lap();
  SPLATLAS_RETURN_IF_ERROR(gunzip(sources.volume));
  parts[kValues] = watch.lap();
#ifdef SPLATLAS_HAS_DRACO
  std::vector<std::uint64_t> triangles;
  for (const std::vector<std::byte>& file : surfaces) {
    SPLATLAS_ASSIGN_OR_RETURN(triangles.emplace_back(), draco_peer::decode(file));
  }
  parts[kSurfaces] = watch.lap();
  for (StructureIndex s = 0; s < triangles.size(); ++s) {
    if (triangles[s] != atlas.triangles(s)) return fail(ErrorCode::kFailed, "Draco lost triangles");
  }
#endif
  return parts;
}

/// Decodes the whole atlas, against gunzip of its volume and labels and, if available, the Draco decoder of
/// its surfaces. Reopens files in each turn. CPU time of one thread.
Result<Table> measure_decoding(const fs::path& file, const SourceFiles& sources, const Atlas& atlas,
                               const BenchOptions& options, nlohmann::ordered_json& summary) {
  Table table{"decoding",
              "Decoding of Colin 27 with AAL: the whole atlas, against gunzip and Draco of its parts",
              {"CPU time of one thread, median of turns; parts have no boundary normals"}};
  options.tell("decoding everything");
  SPLATLAS_ASSIGN_OR_RETURN(const DracoFiles surfaces, draco_files(atlas));
  const std::array<Contender, 2> contenders{[&](int) { return decode_atlas(file); },
                                            [&](int) { return decode_parts(sources, surfaces, atlas); }};
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<StageTimes> times,
                            measure_interleaved(contenders, options.quick ? 3 : 9));
  double ours_ms = 0, theirs_ms = 0;
  const auto add = [&](const char* part, double ours, double theirs) {
    table.rows.push_back(
        {{"part", part},
         {"atlas_cpu_ms", ours},
         {"parts_cpu_ms", theirs},
         {"ratio", theirs > 0 ? nlohmann::ordered_json(ours / theirs) : nlohmann::ordered_json()}});
  };
  for (std::size_t part = 0; part < kAllParts; ++part) {
    const double ours = median(times[0][part]).cpu_ms, theirs = median(times[1][part]).cpu_ms;
    add(kPartNames[part], ours, theirs);
    ours_ms += ours;
    theirs_ms += theirs;
    if (part == kValues) summary["decode_images_vs_gunzip"] = ours_ms / theirs_ms;
  }
  add("everything", ours_ms, theirs_ms);
  summary["decode_all_vs_parts"] = ours_ms / theirs_ms;
  return table;
}

}  // namespace

Result<Report> run_size_bench(const BenchOptions& options) {
  Report report;
  SPLATLAS_ASSIGN_OR_RETURN(const SourceFiles sources, aal_sources());
  const TemporaryFolder folder;
  options.tell("building the atlases of Colin 27 with AAL");
  const fs::path file = folder.path() / "full.atlas";
  SPLATLAS_ASSIGN_OR_RETURN(const auto full, build(file, sources, false));
  SPLATLAS_ASSIGN_OR_RETURN(const auto compact, build(folder.path() / "compact.atlas", sources, true));
  report.tables.push_back(section_table(*full, *compact));
  report.tables.push_back(compare_with_parts(*full, *compact, report.summary));
  std::uint64_t runs = 0;
  for (const char* section : {"runs_x", "runs_y", "runs_z"}) runs += bytes_of_section(*full, section);
  report.summary["runs_bytes_per_voxel"] =
      static_cast<double>(runs) / static_cast<double>(full->grid().voxels());
  SPLATLAS_ASSIGN_OR_RETURN(report.tables.emplace_back(),
                            measure_reading(*full, file, options, report.summary));
  SPLATLAS_ASSIGN_OR_RETURN(report.tables.emplace_back(),
                            measure_decoding(file, sources, *full, options, report.summary));
  return report;
}

}  // namespace splatlas

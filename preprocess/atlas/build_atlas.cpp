#include "preprocess/atlas/build_atlas.h"

#include <algorithm>
#include <cstddef>

#include <fmt/format.h>

#include "format/atlas_reader.h"
#include "format/atlas_writer.h"
#include "format/io/output_file.h"
#include "format/io/output_path.h"
#include "format/result_macros.h"
#include "preprocess/atlas/measure_display.h"
#include "preprocess/classify/classify_voxels.h"
#include "preprocess/import/tables/read_scenes.h"
#include "preprocess/surfaces/extract_surfaces.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

const NoteKind kNotSmoothed{"not-smoothed", "", "", false}, kStoredSurfaces{"stored-surfaces", "", "", false};

Result<void> check_no_warning(const Notes& notes) {
  const auto warning =
      std::ranges::find_if(notes.all(), [](const Note& note) { return note.kind.is_warning; });
  if (warning == notes.all().end()) return {};
  return fail(ErrorCode::kFailed, "--strict: {}; nothing is written", warning->message());
}

/// Source numbers are in the order labels or masks, segments, meshes.
std::size_t first_mesh(const SourceModel& model) {
  return model.structures.size() - model.meshes.size();
}

std::vector<CrossedVoxel> crossed_voxels(const SourceModel& model, const PlacedStructures& placed) {
  std::vector<CrossedVoxel> crossed;
  for (std::size_t n = 0; n < model.meshes.size(); ++n) {
    const StructureIndex structure = placed.index_of_source[first_mesh(model) + n];
    for (const std::int64_t voxel : model.meshes[n].crossed) crossed.push_back({voxel, structure});
  }
  std::sort(crossed.begin(), crossed.end());
  return crossed;
}

std::vector<Isosurface> isosurfaces_of(const SourceModel& model, const PlacedStructures& placed) {
  std::vector<Isosurface> isosurfaces;
  const std::size_t first = first_mesh(model) - model.segments.size();
  for (std::size_t n = 0; n < model.segments.size(); ++n) {
    const SegmentRule& rule = model.segments[n].rule;
    if (rule.kind == SegmentRule::Kind::kIsosurface)
      isosurfaces.push_back({placed.index_of_source[first + n], rule.low});
  }
  return isosurfaces;
}

void note_surfaces(SurfaceRule rule, const Grid& grid, const ExtractedSurfaces& extracted, Notes& notes) {
  if (rule_for(rule, grid.size) != rule) {
    notes.add(kNotSmoothed,
              fmt::format("surfaces are not smoothed: an axis of the grid has more than {} voxels",
                          kMaxSmoothSize));
  }
  if (extracted.not_derived > 0) {
    notes.add(kStoredSurfaces,
              fmt::format("{} surfaces of VTK have other triangles than the file format derives; they "
                          "are stored",
                          extracted.not_derived));
  }
}

/// Builds the structure graph, runs segmentations, classifies the voxels and extracts surfaces. Fills only
/// the hashes of the provenance. Messages about the labels call them `labels`. The content does not depend on
/// `threads` (0: one per core).
Result<AtlasContent> build_content(SourceModel model, const std::string& labels,
                                   const std::vector<SceneFile>& scenes,
                                   const std::vector<FragmentRule>& fragments, SurfaceRule rule,
                                   unsigned threads, StageClock& clock, Notes& notes) {
  AtlasContent content;
  content.source_grid = model.source_grid;
  content.source_to_storage = storage_order(model.source_grid);
  const Grid grid = storage_grid(content);
  SPLATLAS_ASSIGN_OR_RETURN(
      PlacedStructures placed,
      build_graph(model.structures, model.tree, model.tree_file.empty() ? labels : model.tree_file, notes));
  SPLATLAS_ASSIGN_OR_RETURN(content.scenes, scenes_of(scenes, placed.graph));

  if (!model.segments.empty()) clock.begin("segment", 0.2);
  SPLATLAS_RETURN_IF_ERROR(segment_structures(
      model, placed, grid, fragments, [&](double fraction) { clock.update(fraction); }, notes));
  clock.begin("classify", 0.05);
  model.memberships.renumber(placed.index_of_source);
  Result<Classification> classified =
      classify_voxels(std::move(model.memberships), crossed_voxels(model, placed), placed.graph, threads);
  if (!classified) return fail(classified.error().code, "{}: {}", labels, classified.error().message);
  Classification& classification = *classified;

  clock.begin("surfaces", 0.25);
  SPLATLAS_ASSIGN_OR_RETURN(ExtractedSurfaces extracted,
                            extract_surfaces(classification, placed.graph, grid,
                                             {rule, threads, [&](double fraction) { clock.update(fraction); },
                                              isosurfaces_of(model, placed), &model.values, false}));
  note_surfaces(rule, grid, extracted, notes);
  for (std::size_t n = 0; n < model.meshes.size(); ++n) {
    extracted.surfaces[placed.index_of_source[first_mesh(model) + n]] = std::move(model.meshes[n].surface);
  }
  content.display = measure_display(classification, placed.graph, model.values, grid);

  content.graph = std::move(placed.graph);
  content.classes = std::move(classification.classes);
  SPLATLAS_ASSIGN_OR_RETURN(content.class_volume, decode_runs(classification.runs, grid.size));
  content.values = std::move(model.values);
  content.label_type = model.label_type;
  content.surfaces = std::move(extracted.surfaces);
  content.fitted = std::move(extracted.fitted);
  content.boundary_normals = std::move(extracted.boundary_normals);
  content.provenance.sources = std::move(model.provenance);
  return content;
}

/// Reopens the encoded atlas before writing, so that an invalid one never replaces an old file.
Result<BuildReport> report_on(const std::vector<std::byte>& bytes, const fs::path& output,
                              std::uint64_t structures) {
  SPLATLAS_ASSIGN_OR_RETURN(const auto atlas, Atlas::open_bytes(bytes, output.string()));
  BuildReport report;
  report.structures = structures;
  report.classes = atlas->classes().size();
  for (const Axis axis : kAxes) report.runs[static_cast<std::size_t>(axis)] = atlas->runs(axis);
  for (StructureIndex s = 0; s < structures; ++s) report.triangles += atlas->triangles(s);
  report.bytes = atlas->counters().file;
  return report;
}

}  // namespace

Result<BuildReport> build_atlas(const BuildOptions& options) {
  Notes notes;
  return build_atlas(options, notes);
}

Result<BuildReport> build_atlas(const BuildOptions& options, Notes& notes,
                                const std::function<Result<void>(std::vector<OutputFile>&)>& add_files) {
  SPLATLAS_RETURN_IF_ERROR(check_outputs(std::array{options.output}, list_files(options.sources)));
  SPLATLAS_RETURN_IF_ERROR(check_writable_file(options.output));
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<SceneFile> scenes, read_scenes(options.sources.scenes));
  StageClock clock(options.progress);
  const auto update = [&](double fraction) { clock.update(fraction); };

  clock.begin("read", 0.1);
  SPLATLAS_ASSIGN_OR_RETURN(SourceModel model, import_sources(options.sources, notes, update));
  SPLATLAS_ASSIGN_OR_RETURN(
      AtlasContent content,
      build_content(std::move(model), options.sources.labels.string(), scenes, options.fragments,
                    options.surfaces, options.threads, clock, notes));
  if (options.strict) SPLATLAS_RETURN_IF_ERROR(check_no_warning(notes));
  content.provenance.title = options.title;
  content.provenance.citation = options.citation;
  content.provenance.licence = options.licence;
  content.provenance.tool = options.tool;

  clock.begin("write", 0.4);
  const WriteOptions writing{options.level, options.compact, options.threads, update};
  const std::uint64_t structures = content.graph.size();
  Result<std::vector<std::byte>> bytes = encode_atlas(std::move(content), writing);
  if (!bytes) return fail(bytes.error().code, "{}: {}", options.output.string(), bytes.error().message);
  SPLATLAS_ASSIGN_OR_RETURN(BuildReport report, report_on(*bytes, options.output, structures));
  std::vector<OutputFile> files;
  SPLATLAS_RETURN_IF_ERROR(add_file(options.output, *bytes, files));
  if (add_files) SPLATLAS_RETURN_IF_ERROR(add_files(files));
  SPLATLAS_RETURN_IF_ERROR(commit_files(files));
  clock.end();

  report.stages = clock.stages();
  report.notes = notes;
  return report;
}

}  // namespace splatlas

#include "preprocess/atlas/build_atlas.h"

#include <cmath>
#include <cstddef>
#include <map>
#include <tuple>

#include <fmt/format.h>

#include "format/atlas_writer.h"
#include "format/derive/distinct_colors.h"
#include "format/derive/value_groups.h"
#include "format/result_macros.h"
#include "preprocess/import/tables/read_scenes.h"
#include "preprocess/import/tables/text_file.h"
#include "preprocess/structures/graph_parts.h"
#include "preprocess/surfaces/extract_surfaces.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

Result<void> check_no_warning(const Notes& notes) {
  const auto warning =
      std::ranges::find_if(notes.all(), [](const Note& note) { return note.level() == NoteLevel::kWarning; });
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

/// The graph with colours, apart from those of neighbours, for structures that have none in the sources and
/// the tree. The sides of one whole, and left and right of one name, have one colour.
Result<StructureGraph> with_distinct_colors(const SourceModel& model, const PlacedStructures& placed,
                                            const ClassifiedVoxels& voxels, const Index3& size) {
  const auto all = placed.graph.structures();
  std::vector<Structure> structures(all.begin(), all.end());
  std::vector<std::optional<Rgb>> given, wished(structures.size());
  std::vector<StructureIndex> uncolored, one_of;  // one_of: [structure], that whose colour it has
  for (const Structure& structure : structures) given.emplace_back(structure.color);
  for (StructureIndex s = 0; s < given.size(); ++s) one_of.push_back(s);
  std::map<std::tuple<std::string, std::string, char>, StructureIndex> partners;
  for (std::size_t n = 0; n < model.structures.size(); ++n) {
    const SourceStructure& source = model.structures[n];
    const StructureIndex s = placed.index_of_source[n];
    if (source.whole) one_of[s] = one_of[placed.index_of_source[*source.whole]];
    if (source.whole || source.color || placed.colored.contains(s)) continue;
    uncolored.push_back(s);
    wished[s] = anatomical_color(source.name, source.terms);
    const SidedName sided = sided_name(source.name);
    if (sided.side == 0 || !wished[s]) continue;
    const auto partner = partners.find({source.group, sided.rest, sided.side == 'l' ? 'r' : 'l'});
    if (partner == partners.end()) {
      partners.emplace(std::tuple(source.group, sided.rest, sided.side), s);
    } else if (wished[partner->second] == wished[s]) {
      one_of[s] = partner->second;
      partners.erase(partner);
    }
  }
  if (uncolored.empty()) return placed.graph;
  auto touching = touching_structures(all.size(), voxels.classes, voxels.runs.classes, size);
  for (StructureIndex s = 0; s < touching.size(); ++s) {
    for (StructureIndex& other : touching[s]) other = one_of[other];
    if (one_of[s] == s) continue;
    touching[one_of[s]].insert(touching[one_of[s]].end(), touching[s].begin(), touching[s].end());
  }
  for (const StructureIndex s : uncolored) {
    std::erase(touching[s], s);
    if (!touching[s].empty() && one_of[s] == s) given[s].reset();
  }
  const std::vector<Rgb> colors = distinct_colors(touching, given, wished);
  for (StructureIndex s = 0; s < structures.size(); ++s) structures[s].color = colors[one_of[s]];
  return StructureGraph::build(std::move(structures));
}

void note_surfaces(SurfaceRule rule, const Grid& grid, const ExtractedSurfaces& extracted, Notes& notes) {
  if (!admits(grid.size, rule)) {
    notes.add("not-smoothed",
              fmt::format("surfaces are not smoothed: an axis of the grid has more than {} voxels",
                          kMaxSmoothSize));
  }
  if (extracted.not_derived > 0) {
    notes.add("stored-surfaces",
              fmt::format("{} surfaces of VTK have other triangles than the file format derives; they "
                          "are stored",
                          extracted.not_derived));
  }
}

/// [class]: true if its grey values contribute to the window.
std::vector<bool> classes_to_window(const ClassTable& classes, const StructureGraph& graph) {
  const bool any_label = std::any_of(graph.structures().begin(), graph.structures().end(),
                                     [](const Structure& s) { return s.label.has_value(); });
  std::vector<bool> counts(classes.size(), false);
  for (ClassId c = 0; c < classes.size(); ++c) {
    for (const Membership& m : classes.members(c)) {
      if (m.holds() && (!any_label || graph[m.structure].label)) counts[c] = true;
    }
  }
  return counts;
}

/// Finite grey values of the contributing classes, subsampled regularly if there are many.
std::vector<double> sample_values(const ClassifiedVoxels& classification, const std::vector<bool>& counts,
                                  const VoxelBuffer& values, std::uint64_t width) {
  constexpr std::uint64_t kMaxSamples = std::uint64_t{1} << 22;
  std::uint64_t voxels = 0;
  for (ClassId c = 0; c < counts.size(); ++c) voxels += counts[c] ? classification.classes.voxels(c) : 0;
  const std::uint64_t step = std::max<std::uint64_t>(1, voxels / kMaxSamples);
  std::vector<ClassId> ids;
  std::vector<ClassRuns> runs;
  for (ClassId c = 0; c < counts.size(); ++c) {
    if (!counts[c]) continue;
    ids.push_back(c);
    runs.push_back(classification.runs.classes[c]);
  }
  std::vector<double> samples;
  samples.reserve(voxels / step + 1);
  visit_voxel_type(values.type, [&]<typename T>(T) {
    std::uint64_t next = 0;  // voxels until the next sample
    for (const auto& [run, id] : merge_runs(ids, runs)) {
      const T* const first = values.as<T>() + run.scanline * width + run.start;
      for (; next < run.length; next += step) {
        if (const auto value = static_cast<double>(first[next]); std::isfinite(value))
          samples.push_back(value);
      }
      next -= run.length;
    }
  });
  return samples;
}

double percentile(std::vector<double>& samples, double percent) {
  const auto rank = static_cast<std::ptrdiff_t>(percent / 100 * static_cast<double>(samples.size() - 1));
  std::nth_element(samples.begin(), samples.begin() + rank, samples.end());
  return samples[static_cast<std::size_t>(rank)];
}

/// First and last voxels of the rows with a voxel of a class other than the empty one.
std::vector<IndexBox> ends_of_rows(const RunModel& runs, const Index3& size) {
  std::vector<IndexBox> rows(static_cast<std::size_t>(size[1] * size[2]));
  for (const ClassRuns& of_class : runs.classes) {
    for (const Run& run : of_class) {
      const auto scanline = static_cast<std::int64_t>(run.scanline);
      const std::int64_t j = scanline % size[1], k = scanline / size[1];
      rows[run.scanline].include(
          IndexBox{{run.start, j, k}, {std::int64_t{run.start} + run.length - 1, j, k}});
    }
  }
  std::erase_if(rows, [](const IndexBox& row) { return row.empty(); });
  return rows;
}

void measure_sphere(const RunModel& runs, const Grid& grid, Display& display) {
  const std::vector<IndexBox> rows = ends_of_rows(runs, grid.size);
  IndexBox box;
  for (const IndexBox& row : rows) box.include(row);
  const bool nothing = box.empty();
  if (nothing) box = {{0, 0, 0}, {grid.size[0] - 1, grid.size[1] - 1, grid.size[2] - 1}};
  Vec3 center;
  for (std::size_t a = 0; a < 3; ++a) center[a] = 0.5 * static_cast<double>(box.first[a] + box.last[a]);
  const Affine to_mm = index_to_lps_mm(grid);
  display.center_lps_mm = to_mm.apply(center);

  double farthest = 0;  // squared, mm
  const auto include_voxel = [&](const Index3& at) {
    for (unsigned corner = 0; corner < 8; ++corner) {
      Vec3 from_center;
      for (std::size_t a = 0; a < 3; ++a)
        from_center[a] = static_cast<double>(at[a]) + ((corner >> a & 1u) != 0 ? 0.5 : -0.5) - center[a];
      const Vec3 mm = to_mm.apply_linear(from_center);
      farthest = std::max(farthest, mm[0] * mm[0] + mm[1] * mm[1] + mm[2] * mm[2]);
    }
  };
  for (const IndexBox& row : nothing ? std::vector{box} : rows) {
    include_voxel(row.first);  // a sphere is convex: the ends of a row suffice
    include_voxel(row.last);
  }
  display.radius_mm = std::sqrt(farthest);
}

/// Builds the structure graph, runs segmentations, classifies the voxels and extracts surfaces. Fills only
/// the hashes of the provenance.
Result<AtlasContent> build_content(SourceModel model, const BuildOptions& options,
                                   const std::vector<SceneFile>& scenes, StageClock& clock, Notes& notes) {
  const std::string labels = options.sources.labels.string();
  const auto update = [&](double fraction) { clock.update(fraction); };
  AtlasContent content;
  content.source_grid = model.source_grid;
  content.source_to_storage = storage_order(model.source_grid);
  const Grid grid = storage_grid(content);
  SPLATLAS_ASSIGN_OR_RETURN(
      PlacedStructures placed,
      build_graph(model.structures, model.tree, model.tree_file.empty() ? labels : model.tree_file, notes));
  SPLATLAS_ASSIGN_OR_RETURN(content.scenes, scenes_of(scenes, placed.graph));

  if (!model.segments.empty()) clock.begin("segment", 0.2);
  SPLATLAS_RETURN_IF_ERROR(segment_structures(model, placed, grid, options.fragments, update, notes));
  clock.begin("classify", 0.05);
  model.memberships.renumber(placed.index_of_source);
  Result<ClassifiedVoxels> classified = classify_voxels(
      std::move(model.memberships), crossed_voxels(model, placed), placed.graph, options.threads);
  if (!classified) return fail(classified.error().code, "{}: {}", labels, classified.error().message);
  ClassifiedVoxels& classification = *classified;

  clock.begin("surfaces", 0.25);
  SPLATLAS_ASSIGN_OR_RETURN(ExtractedSurfaces extracted,
                            extract_surfaces(classification, placed.graph, grid,
                                             {options.surfaces, options.threads, update,
                                              isosurfaces_of(model, placed), &model.values, false}));
  note_surfaces(options.surfaces, grid, extracted, notes);
  for (std::size_t n = 0; n < model.meshes.size(); ++n) {
    extracted.surfaces[placed.index_of_source[first_mesh(model) + n]] = std::move(model.meshes[n].surface);
  }
  content.display = measure_display(classification, placed.graph, model.values, grid);

  SPLATLAS_ASSIGN_OR_RETURN(content.graph, with_distinct_colors(model, placed, classification, grid.size));
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

BuildReport report_on(const Atlas& atlas) {
  BuildReport report;
  report.structures = atlas.graph().size();
  report.classes = atlas.classes().size();
  for (const Axis axis : kAxes) report.runs[static_cast<std::size_t>(axis)] = atlas.runs(axis);
  for (StructureIndex s = 0; s < report.structures; ++s) report.triangles += atlas.triangles(s);
  report.bytes = atlas.counters().file;
  return report;
}

}  // namespace

Display measure_display(const ClassifiedVoxels& classification, const StructureGraph& graph,
                        const VoxelBuffer& values, const Grid& storage_grid) {
  Display display;
  measure_sphere(classification.runs, storage_grid, display);
  if (values.empty()) return display;
  std::vector<double> samples =
      sample_values(classification, classes_to_window(classification.classes, graph), values,
                    static_cast<std::uint64_t>(storage_grid.size[0]));
  if (samples.empty()) return display;
  display.window_low = percentile(samples, 1);
  display.window_high = percentile(samples, 99.5);
  if (!(display.window_high > display.window_low)) display.window_low = display.window_high - 1;
  return display;
}

Result<BuildReport> build_atlas(const BuildOptions& options) {
  Notes notes;
  return build_atlas(options, notes);
}

Result<BuildReport> build_atlas(
    const BuildOptions& options, Notes& notes,
    const std::function<Result<void>(const Atlas&, std::vector<OutputFile>&)>& add_files) {
  SPLATLAS_RETURN_IF_ERROR(check_outputs(std::array{options.output}, list_files(options.sources)));
  SPLATLAS_RETURN_IF_ERROR(check_writable_file(options.output));
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<SceneFile> scenes, read_scenes(options.sources.scenes));
  StageClock clock(options.progress);
  const auto update = [&](double fraction) { clock.update(fraction); };

  clock.begin("read", 0.1);
  SPLATLAS_ASSIGN_OR_RETURN(SourceModel model, import_sources(options.sources, notes, update));
  SPLATLAS_ASSIGN_OR_RETURN(AtlasContent content,
                            build_content(std::move(model), options, scenes, clock, notes));
  if (options.strict) SPLATLAS_RETURN_IF_ERROR(check_no_warning(notes));
  content.provenance.title = options.title;
  content.provenance.citation = options.citation;
  content.provenance.licence = options.licence;
  content.provenance.tool = options.tool;

  clock.begin("write", 0.4);
  const WriteOptions writing{options.level, options.compact, options.threads, update};
  Result<std::vector<std::byte>> bytes = encode_atlas(std::move(content), writing);
  if (!bytes) return fail(bytes.error().code, "{}: {}", options.output.string(), bytes.error().message);
  // Reopened before writing, so that an invalid atlas never replaces an old file
  SPLATLAS_ASSIGN_OR_RETURN(const auto atlas, Atlas::open_bytes(*bytes, options.output.string()));
  BuildReport report = report_on(*atlas);
  std::vector<OutputFile> files;
  SPLATLAS_RETURN_IF_ERROR(add_file(options.output, *bytes, files));
  if (add_files) SPLATLAS_RETURN_IF_ERROR(add_files(*atlas, files));
  SPLATLAS_RETURN_IF_ERROR(commit_files(files));
  clock.end();

  report.stages = clock.stages();
  report.notes = notes;
  return report;
}

}  // namespace splatlas

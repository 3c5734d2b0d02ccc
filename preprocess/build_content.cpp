#include "preprocess/build_content.h"

#include <algorithm>

#include "format/system/result_macros.h"
#include "preprocess/classify/classify_voxels.h"
#include "preprocess/measure_display.h"
#include "preprocess/surfaces/extract_surfaces.h"

namespace splatlas {
namespace {

/// Source numbers are in the order labels or masks, segments, meshes.
std::size_t first_mesh(const SourceModel& model) {
  return model.structures.size() - model.meshes.size();
}
std::size_t first_segment(const SourceModel& model) {
  return first_mesh(model) - model.segments.size();
}

/// Adds the segments. A segment gets only voxels that no structure contains yet.
Result<void> segment(SourceModel& model, const Grid& grid, StageClock& clock,
                     std::vector<std::string>& notes) {
  for (std::size_t n = 0; n < model.segments.size(); ++n) {
    auto& [rule, mask] = model.segments[n];
    if (rule.kind != SegmentRule::Kind::kMask) {
      SPLATLAS_ASSIGN_OR_RETURN(mask, segment_volume(model.values, grid, rule));
    }
    const auto sets = model.memberships.voxels();
    for (std::size_t v = 0; v < mask.size(); ++v) mask[v] = mask[v] != 0 && sets[v] == 0;
    const auto structure = static_cast<StructureIndex>(first_segment(model) + n);
    if (model.memberships.add(structure, mask) == 0) {
      notes.push_back("segment '" + rule.name + "' has no voxel outside the other structures");
    }
    mask = {};
    clock.update(static_cast<double>(n + 1) / static_cast<double>(model.segments.size()));
  }
  return {};
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

}  // namespace

Result<AtlasContent> build_content(SourceModel model, unsigned threads, StageClock& clock,
                                   std::vector<std::string>& notes) {
  AtlasContent content;
  content.source_grid = model.source_grid;
  content.source_to_storage = storage_order(model.source_grid);
  const Grid grid = storage_grid(content);
  SPLATLAS_ASSIGN_OR_RETURN(PlacedStructures placed,
                            build_graph(model.structures, model.tree, model.tree_file));

  if (!model.segments.empty()) {
    clock.begin("segment", 0.2);
    SPLATLAS_RETURN_IF_ERROR(segment(model, grid, clock, notes));
  }
  clock.begin("classify", 0.05);
  model.memberships.renumber(placed.index_of_source);
  SPLATLAS_ASSIGN_OR_RETURN(
      Classification classification,
      classify_voxels(model.memberships, crossed_voxels(model, placed), placed.graph, threads));
  model.memberships = MembershipVolume(Index3{0, 0, 0});

  clock.begin("surfaces", 0.25);
  ExtractedSurfaces extracted = extract_surfaces(classification, placed.graph, grid, threads,
                                                 [&](double fraction) { clock.update(fraction); });
  for (std::size_t n = 0; n < model.meshes.size(); ++n) {
    extracted.surfaces[placed.index_of_source[first_mesh(model) + n]] = std::move(model.meshes[n].surface);
  }
  content.display = measure_display(classification, placed.graph, model.values, grid);

  content.graph = std::move(placed.graph);
  content.classes = std::move(classification.classes);
  content.class_volume = std::move(classification.volume);
  content.values = std::move(model.values);
  content.label_type = model.label_type;
  content.surfaces = std::move(extracted.surfaces);
  content.boundary_normals = std::move(extracted.boundary_normals);
  content.provenance.sources = std::move(model.provenance);
  return content;
}

}  // namespace splatlas

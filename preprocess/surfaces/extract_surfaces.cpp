#include "preprocess/surfaces/extract_surfaces.h"

#include <algorithm>

#include "format/derive/fit_surface.h"
#include "format/derive/structure_crop.h"
#include "format/file/fitted_content.h"
#include "format/result_macros.h"
#include "format/tasks/thread_pool.h"
#include "preprocess/import/quiet_vtk.h"
#include "preprocess/surfaces/vtk_surface.h"

namespace splatlas {
namespace {

/// Extracts the surface and the boundary normals of single structures.
struct StructureExtractor {
  const ClassifiedVoxels& classification;
  const StructureClasses& structure_classes;
  const Grid& grid;
  const ExtractOptions& options;
  std::span<const StructureIndex> normal_owner;
  std::span<std::vector<PackedNormal>> normals;  ///< [class]
  SurfaceRule rule = rule_for(options.rule, grid);
  VoxelNormals voxel_normals{grid};

  struct Extracted {
    SurfaceMesh mesh;
    bool is_derived = true;
    FittedSurface fitted;
  };
  /// The surface of a structure within `box`; writes the normals of the boundary voxels that it owns.
  [[nodiscard]] Result<Extracted> extract(StructureIndex structure, const IndexBox& box) const {
    const std::span<const StructureClass> members = structure_classes.of(structure);
    const StructureCrop crop = crop_structure(classification.runs, grid.size[1], box, members);
    std::vector<RunsBySlice> owned;
    for (const StructureClass& h : members) {
      if (normal_owner[h.id] == structure) owned.push_back({h.id, classification.runs.classes[h.id]});
    }
    Extracted result;
    const SurfaceRule on_edges = rule == SurfaceRule::kUneven ? SurfaceRule::kSmooth : rule;  // as VTK's are
    result.mesh = fit_surface(crop, grid, on_edges, [&](const SmoothGradient& gradient, std::int64_t k) {
      for (RunsBySlice& runs : owned) {
        runs.visit_slice(k, crop, grid.size[1], [&](std::int64_t i, std::int64_t j) {
          normals[runs.id].push_back(voxel_normals.normal(gradient.at(i, j)));
        });
      }
    });
    SPLATLAS_ASSIGN_OR_RETURN(const EdgeTriangles vtk, extract_with_vtk(crop));
    SPLATLAS_ASSIGN_OR_RETURN(result.is_derived, adopt_triangles(vtk, crop, grid, result.mesh));
    const auto isosurface = std::ranges::find(options.isosurfaces, structure, &Isosurface::structure);
    if (isosurface != options.isosurfaces.end()) {
      SPLATLAS_RETURN_IF_ERROR(
          move_to_isosurface(*options.values, isosurface->level, crop, grid, vtk, result.mesh));
      result.is_derived = true;  // nothing to note: isosurfaces are stored anyway
    } else if (!options.keeps_fitted && result.is_derived && crop_voxels(box) <= kMaxFittedVoxels) {
      result.fitted = {rule, static_cast<std::uint32_t>(result.mesh.positions_ijk.size()),
                       static_cast<std::uint32_t>(result.mesh.triangles.size())};
      result.mesh = {};
    } else if (rule == SurfaceRule::kUneven) {
      result.mesh.positions_ijk = fit_surface(crop, grid, rule).positions_ijk;
      result.mesh.position_scale = static_cast<std::uint32_t>(rule);
    }
    return result;
  }
};

/// Structures with voxels, largest boxes first for load balancing.
std::vector<std::pair<StructureIndex, IndexBox>> structures_to_extract(
    const ClassTable& classes, const StructureClasses& structure_classes, const StructureGraph& graph) {
  std::vector<std::pair<StructureIndex, IndexBox>> result;
  for (StructureIndex s = 0; s < graph.size(); ++s) {
    const IndexBox box = box_of(classes, structure_classes.of(s));
    if (!box.empty()) result.emplace_back(s, box);
  }
  std::ranges::stable_sort(result, std::greater{}, [](const auto& one) { return crop_voxels(one.second); });
  return result;
}

}  // namespace

Result<ExtractedSurfaces> extract_surfaces(const ClassifiedVoxels& classification,
                                           const StructureGraph& graph, const Grid& storage_grid,
                                           const ExtractOptions& options) {
  ExtractedSurfaces result;
  result.surfaces.resize(graph.size());
  result.fitted.resize(graph.size());
  const std::vector<StructureIndex> owners = normal_owners(classification.classes);
  result.boundary_normals.resize(owners.size());
  const StructureClasses structure_classes(classification.classes, graph.size());
  const StructureExtractor extractor{classification, structure_classes,      storage_grid, options,
                                     owners,         result.boundary_normals};
  const auto structures = structures_to_extract(classification.classes, structure_classes, graph);

  initialize_vtk();
  std::vector<Result<StructureExtractor::Extracted>> extracted(structures.size());
  parallel_for(
      structures.size(), options.threads,
      [&](std::size_t n) { extracted[n] = extractor.extract(structures[n].first, structures[n].second); },
      [&](std::size_t done) {
        if (options.progress)
          options.progress(static_cast<double>(done) / static_cast<double>(structures.size()));
      });
  for (std::size_t n = 0; n < structures.size(); ++n) {
    const StructureIndex structure = structures[n].first;
    if (!extracted[n]) {
      return fail(extracted[n].error().code, "surface of structure '{}': {}", graph[structure].id,
                  extracted[n].error().message);
    }
    result.surfaces[structure] = std::move(extracted[n]->mesh);
    result.fitted[structure] = extracted[n]->fitted;
    if (!extracted[n]->is_derived) ++result.not_derived;
  }
  return result;
}

}  // namespace splatlas

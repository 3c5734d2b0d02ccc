// Derived surfaces and normals, which files leave out.
#pragma once

#include "format/content/atlas_content.h"
#include "format/derive/fit_surface.h"

namespace splatlas {

/// Replaces surface and normals of a structure with voxels by those that readers derive, as preprocess does.
inline void fit_parts(AtlasContent& content, StructureIndex s, SurfaceRule rule = SurfaceRule::kSmooth) {
  const Grid grid = storage_grid(content);
  const StructureClasses held(content.classes, content.graph.size());
  const IndexBox box = box_of(content.classes, held.of(s));
  if (box.empty()) return;
  const RunModel runs = encode_runs(content.class_volume, grid.size, Axis::kZ, content.classes.size());
  const std::vector<StructureIndex> owners = normal_owners(content.classes);
  std::vector<RunsBySlice> owned;
  for (const StructureClass& h : held.of(s)) {
    if (owners[h.id] != s) continue;
    content.boundary_normals[h.id].clear();
    owned.push_back({h.id, runs.classes[h.id]});
  }
  const StructureCrop crop = crop_structure(runs, grid.size[1], box, held.of(s));
  content.surfaces[s] =
      fit_surface(crop, grid, rule, [&](const SmoothGradient& gradient, std::int64_t slice) {
        for (RunsBySlice& of_class : owned) {
          of_class.visit_slice(slice, crop, grid.size[1], [&](std::int64_t i, std::int64_t j) {
            content.boundary_normals[of_class.id].push_back(VoxelNormals(grid).normal(gradient.at(i, j)));
          });
        }
      });
}

/// The content with fit_parts() of every structure.
[[nodiscard]] inline AtlasContent fitted(AtlasContent content, SurfaceRule rule = SurfaceRule::kSmooth) {
  for (StructureIndex s = 0; s < content.graph.size(); ++s) fit_parts(content, s, rule);
  return content;
}
/// The same with the first `rules` rules in turn.
[[nodiscard]] inline AtlasContent fitted_by_all_rules(AtlasContent content, std::size_t rules = 3) {
  constexpr std::array kRules{SurfaceRule::kSmooth, SurfaceRule::kVoxels, SurfaceRule::kUneven};
  for (StructureIndex s = 0; s < content.graph.size(); ++s) fit_parts(content, s, kRules[s % rules]);
  return content;
}

}  // namespace splatlas

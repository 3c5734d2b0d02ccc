// Derived surfaces and normals, which files leave out.
#pragma once

#include "format/content/atlas_content.h"
#include "format/derive/fit_surface.h"

namespace splatlas {

/// Replaces the surface and normals of a structure with voxels by those that readers derive from them, as
/// preprocess does.
inline void fit_parts(AtlasContent& content, StructureIndex s, SurfaceRule rule = SurfaceRule::kSmooth) {
  const Grid grid = storage_grid(content);
  const StructureClasses held(content.classes, content.graph.size());
  const IndexBox box = box_of(content.classes, held.of(s));
  if (box.empty()) return;
  const std::vector<StructureIndex> owners = normal_owners(content.classes);
  for (ClassId c = 0; c < owners.size(); ++c) {
    if (owners[c] == s) content.boundary_normals[c].clear();
  }
  const StructureCrop crop =
      crop_structure(content.class_volume, grid.size, box, parts_of(held.of(s), content.classes.size()));
  content.surfaces[s] =
      fit_surface(crop, grid, rule, [&](const SmoothGradient& gradient, std::int64_t slice) {
        const std::int64_t k = crop.first[2] + slice;
        if (k < box.first[2] || k > box.last[2]) return;
        for (std::int64_t j = box.first[1]; j <= box.last[1]; ++j) {
          for (std::int64_t i = box.first[0]; i <= box.last[0]; ++i) {
            const ClassId c = content.class_volume[static_cast<std::size_t>(grid.offset(i, j, k))];
            if (owners[c] != s) continue;
            content.boundary_normals[c].push_back(
                VoxelNormals(grid).normal(gradient.at(i - crop.first[0], j - crop.first[1])));
          }
        }
      });
}

/// The content with fit_parts() of every structure.
[[nodiscard]] inline AtlasContent fitted(AtlasContent content, SurfaceRule rule = SurfaceRule::kSmooth) {
  for (StructureIndex s = 0; s < content.graph.size(); ++s) fit_parts(content, s, rule);
  return content;
}
/// The same with all rules in turn.
[[nodiscard]] inline AtlasContent fitted_by_all_rules(AtlasContent content) {
  constexpr std::array kRules{SurfaceRule::kSmooth, SurfaceRule::kVoxels};
  for (StructureIndex s = 0; s < content.graph.size(); ++s) fit_parts(content, s, kRules[s % kRules.size()]);
  return content;
}

}  // namespace splatlas

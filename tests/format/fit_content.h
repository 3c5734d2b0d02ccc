// Content with derived surfaces and normals.
#pragma once

#include <cstddef>
#include <utility>

#include "format/atlas_content.h"
#include "format/derive/fit_surface.h"
#include "format/file/fitted_content.h"

namespace splatlas {

/// The content with surfaces and normals derived from its voxels.
[[nodiscard]] inline AtlasContent fitted(AtlasContent content) {
  const Grid grid = storage_grid(content);
  const StructureClasses held(content.classes, content.graph.size());
  for (StructureIndex s = 0; s < content.graph.size(); ++s) {
    const IndexBox box = box_of(content.classes, held.of(s));
    if (box.empty()) continue;
    const auto parts = parts_of(held.of(s), content.classes.size());
    const StructureCrop crop = crop_structure(content.class_volume, grid.size, box, parts);
    content.surfaces[s] = fit_surface(crop, grid, [&](const SmoothGradient& gradient, std::int64_t k) {
      for (ClassId c = 0; c < content.classes.size(); ++c) {
        if (normal_owner(content.classes.members(c)) != s) continue;
        std::size_t n = 0;
        for (std::int64_t v = 0; v < grid.voxels(); ++v) {
          if (content.class_volume[static_cast<std::size_t>(v)] != c) continue;
          const std::int64_t i = v % grid.size[0], j = v / grid.size[0] % grid.size[1],
                             at_k = v / grid.size[0] / grid.size[1];
          if (at_k - crop.first[2] == k) {
            content.boundary_normals[c][n] =
                VoxelNormals(grid).normal(gradient.at(i - crop.first[0], j - crop.first[1]));
          }
          ++n;
        }
      }
    });
  }
  return content;
}

}  // namespace splatlas

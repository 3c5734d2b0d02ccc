#include "tests/support/fit_parts.h"

#include "format/derive/fit_surface.h"
#include "format/derive/structure_crop.h"
#include "format/run_model.h"

namespace splatlas {

void fit_parts(AtlasContent& content, StructureIndex s) {
  const Grid grid = storage_grid(content);
  const StructureClasses held(content.classes, content.graph.size());
  const IndexBox box = box_of(content.classes, held.of(s));
  const std::vector<std::uint8_t> parts = parts_of(held.of(s), content.classes.size());
  content.surfaces[s] = fit_surface(crop_structure(content.class_volume, grid.size, box, parts), grid);
  const RunModel runs = encode_runs(content.class_volume, grid.size, Axis::kZ, content.classes.size());
  const std::vector<StructureIndex> owners = normal_owners(content.classes);
  for (ClassId c = 0; c < owners.size(); ++c) {
    if (owners[c] != s) continue;
    StructureCrop crop = empty_crop_around(box);
    for (ClassId of = 0; of < owners.size(); ++of)
      paint_runs(runs.classes[of], grid.size[1], parts[of], crop);
    content.boundary_normals[c] = fit_normals(crop, runs.classes[c], grid);
  }
}

}  // namespace splatlas

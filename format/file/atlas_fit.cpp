// Reading of surfaces and normals, stored or fitted to the voxels.
#include <cstring>
#include <new>
#include <vector>

#include "format/codec/surface_codec.h"
#include "format/derive/fit_surface.h"
#include "format/file/atlas_impl.h"
#include "format/file/fitted_content.h"
#include "format/system/result_macros.h"

namespace splatlas {
namespace {

bool overlap(const IndexBox& box, const StructureCrop& crop) {
  for (std::size_t a = 0; a < 3; ++a) {
    if (box.last[a] < crop.first[a] || box.first[a] >= crop.first[a] + crop.size[a]) return false;
  }
  return !box.empty();
}

}  // namespace

Result<StructureCrop> Atlas::Impl::read_crop(StructureIndex s, const IndexBox& box, bool around) const {
  if (crop_voxels(box) > kMaxFittedVoxels) {
    return named(ErrorCode::kLimit, "structure '{}' is too large to fit a surface to it",
                 directory.graph[s].id);
  }
  StructureCrop crop = around ? empty_crop_around(box) : empty_crop(box);
  for (const auto& [c, part] : structure_classes.of(s)) {
    if (shares_runs(c, Axis::kZ)) {  // paint both classes at once: they are in the same structures
      const auto pair = run_streams.pair_of(c);
      if (c != pair[0]) continue;
      SPLATLAS_ASSIGN_OR_RETURN(const SharedSplit split, read_split_runs(c, Axis::kZ));
      paint_runs(split->interior, grid.size[1], StructureCrop::kInterior, crop);
      paint_runs(split->boundary, grid.size[1], StructureCrop::kBoundary, crop);
      continue;
    }
    if (!overlap(directory.classes.box(c), crop)) continue;
    SPLATLAS_ASSIGN_OR_RETURN(const ClassRuns runs, read_stored_runs(c, Axis::kZ));
    paint_runs(runs, grid.size[1], StructureCrop::part_of(part), crop);
  }
  return crop;
}

Result<SurfaceMesh> Atlas::Impl::fit_surface_of(StructureIndex s) const {
  const SurfaceEntry& entry = directory.surfaces[s];
  const IndexBox box = box_of(directory.classes, structure_classes.of(s));
  SurfaceMesh mesh;
  if (!box.empty()) {
    SPLATLAS_ASSIGN_OR_RETURN(const StructureCrop crop, read_crop(s, box, false));
    mesh = fit_surface(crop, grid);
  }
  if (mesh.positions_ijk.size() == entry.vertices && mesh.triangles.size() == entry.triangles) return mesh;
  return named(ErrorCode::kInvalidAtlas,
               "invalid: surface of structure '{}': {} vertices and {} triangles, its voxels give {} and {}",
               directory.graph[s].id, entry.vertices, entry.triangles, mesh.positions_ijk.size(),
               mesh.triangles.size());
}

Result<std::vector<PackedNormal>> Atlas::Impl::fit_normals_of(ClassId c) const {
  const StructureIndex owner = normal_owner(directory.classes.members(c));
  if (directory.classes.box(c).empty()) return std::vector<PackedNormal>{};
  SPLATLAS_ASSIGN_OR_RETURN(const ClassRuns runs, read_stored_runs(c, Axis::kZ));
  SPLATLAS_ASSIGN_OR_RETURN(const StructureCrop crop, read_crop(owner, directory.classes.box(c), true));
  return fit_normals(crop, runs, grid);
}

Result<SurfaceMesh> Atlas::read_surface(StructureIndex s) const {
  SPLATLAS_RETURN_IF_ERROR(impl_->check_structure(s));
  const SurfaceEntry& entry = impl_->directory.surfaces[s];
  try {
    if (is_fitted(entry)) return impl_->fit_surface_of(s);
    SPLATLAS_ASSIGN_OR_RETURN(const auto bytes,
                              impl_->read_stream(SectionKind::kSurfaces, impl_->surface_stream[s]));
    auto mesh = decode_surface(bytes, entry, impl_->grid.size);
    if (!mesh) {
      return impl_->named(ErrorCode::kInvalidAtlas, "invalid: surface of structure '{}': {}", graph()[s].id,
                          mesh.error().message);
    }
    return mesh;
  } catch (const std::bad_alloc&) {
    return impl_->out_of_memory(fmt::format(" for the surface of structure '{}'", graph()[s].id));
  }
}

Result<std::vector<PackedNormal>> Atlas::read_normals(ClassId c) const {
  SPLATLAS_RETURN_IF_ERROR(impl_->check_class(c));
  try {
    if (has_normals(classes(), c) && !stores_normals(impl_->directory, c)) return impl_->fit_normals_of(c);
    SPLATLAS_ASSIGN_OR_RETURN(const auto bytes, impl_->read_stream(SectionKind::kNormals, c));
    std::vector<PackedNormal> normals(bytes.size() / sizeof(PackedNormal));
    if (!bytes.empty()) std::memcpy(normals.data(), bytes.data(), bytes.size());
    return normals;
  } catch (const std::bad_alloc&) {
    return impl_->out_of_memory(fmt::format(" for the normals of class {}", c));
  }
}

}  // namespace splatlas

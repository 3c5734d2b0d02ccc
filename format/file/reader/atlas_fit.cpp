// Reading of surfaces and normals, stored or fitted to the voxels.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>
#include <vector>

#include "format/codec/surface_codec.h"
#include "format/derive/coarse_surface.h"
#include "format/derive/fit_surface.h"
#include "format/file/fitted_content.h"
#include "format/file/reader/atlas_impl.h"
#include "format/result_macros.h"

namespace splatlas {
namespace {

constexpr double kBytesPerSparseTriangle = 200, kBytesPerFittedVertex = 200;

}  // namespace

template <typename Take>
Result<void> Atlas::Impl::read_parts(StructureIndex s, const IndexBox& near, const Take& take) const {
  for (const auto& [c, part] : structure_classes.of(s)) {
    if (shares_runs(c, Axis::kZ)) {  // take both classes at once: they are in the same structures
      const auto pair = run_streams.pair_of(c);
      if (c != pair[0]) continue;
      SPLATLAS_ASSIGN_OR_RETURN(const SharedSplit split, read_split_runs(c, Axis::kZ));
      take(split->interior, StructureCrop::kInterior);
      take(split->boundary, StructureCrop::kBoundary);
      continue;
    }
    if (!overlap(directory.classes.box(c), near)) continue;
    SPLATLAS_ASSIGN_OR_RETURN(const ClassRuns runs, read_stored_runs(c, Axis::kZ));
    take(runs, StructureCrop::part_of(part));
  }
  return {};
}

Result<StructureCrop> Atlas::Impl::read_crop(StructureIndex s, StructureCrop crop) const {
  const auto paint = [&](const ClassRuns& runs, std::uint8_t part) {
    paint_runs(runs, grid.size[1], part, crop);
  };
  SPLATLAS_RETURN_IF_ERROR(read_parts(s, box_of(crop), paint));
  return crop;
}

Result<PartRows> Atlas::Impl::read_rows(StructureIndex s, const IndexBox& near) const {
  PartRows rows(grid.size);
  SPLATLAS_RETURN_IF_ERROR(
      read_parts(s, near, [&](const ClassRuns& runs, std::uint8_t part) { rows.add(runs, part); }));
  rows.sort();
  return rows;
}

SurfaceRule Atlas::Impl::rule_of_surface(StructureIndex s) const {
  const SurfaceRule rule = rule_of(directory.surfaces[s]);
  if (surfaces == SurfaceChoice::kSmooth) {
    const SurfaceRule smooth = rule_for(SurfaceRule::kSmooth, grid);
    return smooth != SurfaceRule::kVoxels ? smooth : rule;
  }
  return surfaces == SurfaceChoice::kVoxels ? SurfaceRule::kVoxels : rule;
}

Result<SurfaceMesh> Atlas::Impl::fit_surface_of(StructureIndex s) const {
  const SurfaceEntry& entry = directory.surfaces[s];
  const IndexBox box = box_of(directory.classes, structure_classes.of(s));
  std::optional<SurfaceMesh> mesh;
  if (box.empty()) {
    mesh.emplace();
  } else if (fits_sparsely(box, entry.vertices)) {
    check_memory(kBytesPerSparseTriangle * entry.triangles);
    SPLATLAS_ASSIGN_OR_RETURN(const PartRows rows, read_rows(s, box));
    mesh = fit_sparse_surface(rows, grid, rule_of_surface(s), entry.triangles);
  } else {
    check_memory(crop_bytes(box) + kBytesPerFittedVertex * entry.vertices);
    SPLATLAS_ASSIGN_OR_RETURN(const StructureCrop crop, read_crop(s, empty_crop(box)));
    mesh = fit_surface(crop, grid, rule_of_surface(s));
  }
  if (mesh && mesh->positions_ijk.size() == entry.vertices && mesh->triangles.size() == entry.triangles)
    return *std::move(mesh);
  const std::string found =
      mesh ? fmt::format("{} and {}", mesh->positions_ijk.size(), mesh->triangles.size()) : "more";
  return named(ErrorCode::kInvalidAtlas,
               "invalid: surface of structure '{}': {} vertices and {} triangles, its voxels give {}",
               directory.graph[s].id, entry.vertices, entry.triangles, found);
}

/// Nothing if the structure has parts too thin for the level.
Result<std::optional<SurfaceMesh>> Atlas::Impl::fit_coarse_surface(StructureIndex s, int level) const {
  constexpr double kBytesPerBlock = 6, kBytesPerCoarseTriangle = 120;
  const SurfaceEntry& entry = directory.surfaces[s];
  const IndexBox box = box_of(directory.classes, structure_classes.of(s));
  check_memory(kBytesPerBlock * Coverage::blocks(box, level) +
               kBytesPerCoarseTriangle * std::ldexp(entry.triangles, -2 * level));
  Coverage coverage(box, level);
  SPLATLAS_RETURN_IF_ERROR(
      read_parts(s, box, [&](const ClassRuns& runs, std::uint8_t) { coverage.add(runs, grid.size[1]); }));
  return coarse_surface(coverage, grid);
}

Result<std::vector<PackedNormal>> Atlas::Impl::fit_normals_of(ClassId c) const {
  const StructureIndex owner = normal_owner(directory.classes.members(c));
  const IndexBox& box = directory.classes.box(c);
  if (box.empty()) return std::vector<PackedNormal>{};
  SPLATLAS_ASSIGN_OR_RETURN(const ClassRuns runs, read_stored_runs(c, Axis::kZ));
  if (fits_sparsely(box, directory.classes.voxels(c))) {
    SPLATLAS_ASSIGN_OR_RETURN(const PartRows rows, read_rows(owner, around(box)));
    return fit_sparse_normals(rows, runs, grid);
  }
  check_memory(crop_bytes(box));
  SPLATLAS_ASSIGN_OR_RETURN(const StructureCrop crop, read_crop(owner, crop_around(box)));
  return fit_normals(crop, runs, grid);
}

bool Atlas::has_levels(StructureIndex s) const {
  const SurfaceEntry& entry = impl_->directory.surfaces[s];
  const IndexBox box = box_of(classes(), impl_->structure_classes.of(s));
  const bool follows_voxels = is_fitted(entry) || rule_of(entry) == SurfaceRule::kUneven;
  return follows_voxels && !box.empty() && !fits_sparsely(box, entry.vertices);
}

Result<SurfaceMesh> Atlas::read_surface(StructureIndex s, int level) const {
  SPLATLAS_RETURN_IF_ERROR(impl_->check_structure(s));
  const SurfaceEntry& entry = impl_->directory.surfaces[s];
  const auto read = [&]() -> Result<SurfaceMesh> {
    for (int of = has_levels(s) ? std::min(level, Coverage::kMaxLevel) : 0; of > 0; --of) {
      SPLATLAS_ASSIGN_OR_RETURN(std::optional<SurfaceMesh> mesh, impl_->fit_coarse_surface(s, of));
      if (mesh) return *std::move(mesh);
    }
    if (is_fitted(entry)) return impl_->fit_surface_of(s);
    SPLATLAS_ASSIGN_OR_RETURN(const auto bytes,
                              impl_->read_stream(SectionKind::kSurfaces, impl_->surface_stream[s]));
    check_memory(64.0 * entry.vertices + 32.0 * entry.triangles);
    auto mesh = decode_surface(bytes, entry, impl_->grid.size);
    if (!mesh) {
      return impl_->named(ErrorCode::kInvalidAtlas, "invalid: surface of structure '{}': {}", graph()[s].id,
                          mesh.error().message);
    }
    return mesh;
  };
  return impl_->guarded(read, " for the surface of structure '{}'", graph()[s].id);
}

Result<std::vector<PackedNormal>> Atlas::read_normals(ClassId c) const {
  SPLATLAS_RETURN_IF_ERROR(impl_->check_class(c));
  const auto read = [&]() -> Result<std::vector<PackedNormal>> {
    if (has_normals(classes(), c) && !stores_normals(impl_->directory, c)) return impl_->fit_normals_of(c);
    SPLATLAS_ASSIGN_OR_RETURN(const auto bytes, impl_->read_stream(SectionKind::kNormals, c));
    std::vector<PackedNormal> normals(bytes.size() / sizeof(PackedNormal));
    if (!bytes.empty()) std::memcpy(normals.data(), bytes.data(), bytes.size());
    return normals;
  };
  return impl_->guarded(read, " for the normals of class {}", c);
}

}  // namespace splatlas

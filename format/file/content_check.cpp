#include "format/file/content_check.h"

#include <vector>

#include "format/file/directory.h"
#include "format/result_macros.h"

namespace splatlas {

namespace {

Result<void> check_sizes(const AtlasContent& content, std::uint64_t voxels) {
  if (content.class_volume.size() != voxels) {
    return fail(ErrorCode::kFailed, "class volume has {} voxels, the grid has {}",
                content.class_volume.size(), voxels);
  }
  if (content.values.bytes.size() != voxels * bytes_of(content.values.type)) {
    return fail(ErrorCode::kFailed, "values have {} bytes, {} voxels of {} need {}",
                content.values.bytes.size(), voxels, name_of(content.values.type),
                voxels * bytes_of(content.values.type));
  }
  if (content.surfaces.size() != content.graph.size()) {
    return fail(ErrorCode::kFailed, "{} surfaces of {} structures", content.surfaces.size(),
                content.graph.size());
  }
  if (content.classes.size() > kMaxClasses) {
    return fail(ErrorCode::kFailed, "{} classes (limit {})", content.classes.size(), kMaxClasses);
  }
  if (content.boundary_normals.size() != content.classes.size()) {
    return fail(ErrorCode::kFailed, "normals of {} classes, there are {}", content.boundary_normals.size(),
                content.classes.size());
  }
  return {};
}

Result<void> check_members(const AtlasContent& content) {
  const ClassTable& classes = content.classes;
  for (ClassId c = 0; c < classes.size(); ++c) {
    for (const Membership& member : classes.members(c)) {
      if (member.structure >= content.graph.size()) {
        return fail(ErrorCode::kFailed, "class {} belongs to structure {} of {}", c, member.structure,
                    content.graph.size());
      }
    }
    const std::uint64_t normals = has_normals(classes, c) ? classes.voxels(c) : 0;
    if (content.boundary_normals[c].size() != normals) {
      return fail(ErrorCode::kFailed, "class {} has {} normals, expected {}", c,
                  content.boundary_normals[c].size(), normals);
    }
  }
  const std::vector<ClassId> order = storage_order(classes, content.graph);
  for (ClassId c = 0; c < order.size(); ++c) {
    if (order[c] != c)
      return fail(ErrorCode::kFailed, "classes are not in storage order: class {} belongs at {}", order[c],
                  c);
  }
  return {};
}

/// Compares voxel counts and boxes of the class volume with the class table.
Result<void> check_class_volume(const AtlasContent& content, const Index3& size) {
  const ClassTable& classes = content.classes;
  std::vector<std::uint64_t> voxels(classes.size(), 0);
  std::vector<IndexBox> boxes(classes.size());
  const ClassId* next = content.class_volume.data();
  for (std::int64_t k = 0; k < size[2]; ++k) {
    for (std::int64_t j = 0; j < size[1]; ++j) {
      for (std::int64_t i = 0; i < size[0];) {
        const ClassId c = *next;
        if (c >= classes.size()) {
          return fail(ErrorCode::kFailed, "voxel ({}, {}, {}) is of class {} of {}", i, j, k, c,
                      classes.size());
        }
        const std::int64_t first = i;
        while (i < size[0] && *next == c) ++next, ++i;
        voxels[c] += static_cast<std::uint64_t>(i - first);
        boxes[c].include(IndexBox{{first, j, k}, {i - 1, j, k}});
      }
    }
  }
  for (ClassId c = 0; c < classes.size(); ++c) {
    if (voxels[c] != classes.voxels(c)) {
      return fail(ErrorCode::kFailed, "class {} has {} voxels, its table says {}", c, voxels[c],
                  classes.voxels(c));
    }
    if (boxes[c] != classes.box(c) && (c != kEmptyClass || !classes.box(c).empty())) {
      return fail(ErrorCode::kFailed, "the box of class {} does not match its voxels", c);
    }
  }
  return {};
}

}  // namespace

Result<void> check_content(const AtlasContent& content) {
  if (auto valid = validate(content.source_grid, "source grid"); !valid)
    return fail(ErrorCode::kFailed, valid.error().message);
  if (!content.source_to_storage.is_permutation())
    return fail(ErrorCode::kFailed, "axis order is not a permutation");
  const Grid grid = storage_grid(content);
  SPLATLAS_RETURN_IF_ERROR(check_sizes(content, static_cast<std::uint64_t>(grid.voxels())));
  SPLATLAS_RETURN_IF_ERROR(check_members(content));
  return check_class_volume(content, grid.size);
}

}  // namespace splatlas

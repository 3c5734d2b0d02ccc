#include "format/file/fitted_content.h"

#include <algorithm>
#include <optional>

#include "format/derive/fit_surface.h"
#include "format/file/directory.h"
#include "format/result_macros.h"
#include "format/tasks/thread_pool.h"

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
  if (content.surfaces.size() != content.graph.size() ||
      (!content.fitted.empty() && content.fitted.size() != content.graph.size())) {
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

std::optional<SurfaceRule> rule_of(const SurfaceMesh& mesh, const Index3& size) {
  if (mesh.empty()) return std::nullopt;
  for (const SurfaceRule rule : {SurfaceRule::kVoxels, SurfaceRule::kSmooth, SurfaceRule::kUneven}) {
    if (mesh.position_scale == static_cast<std::uint32_t>(rule) && admits(size, rule)) return rule;
  }
  return std::nullopt;
}

/// Compares fitted surfaces and normals with those of the content.
class FitComparer {
 public:
  FitComparer(const AtlasContent& content, const RunModel& runs)
      : content_(content),
        runs_(runs),
        grid_(storage_grid(content)),
        voxel_normals_(grid_),
        structure_classes_(content.classes, content.graph.size()),
        owners_(normal_owners(content.classes)),
        normals_differ_(content.classes.size(), 0) {}

  /// Compares the surface, and the normals of the classes owned by s. Threads may process different
  /// structures concurrently, because each class has one owner.
  [[nodiscard]] FittedSurface fitted_surface(StructureIndex s) {
    if (!content_.fitted.empty() && content_.fitted[s].triangles > 0) return content_.fitted[s];
    const std::span<const StructureClass> members = structure_classes_.of(s);
    const IndexBox box = box_of(content_.classes, members);
    const std::optional<SurfaceRule> rule = rule_of(content_.surfaces[s], grid_.size);
    const bool fits = !box.empty() && crop_voxels(box) <= kMaxFittedVoxels;
    const auto is_owned = [&](const StructureClass& h) { return owners_[h.id] == s; };
    if (!fits) {
      for (const StructureClass& h : members) {
        if (is_owned(h)) normals_differ_[h.id] = 1;
      }
    }
    if (!fits || (!rule && std::ranges::none_of(members, is_owned))) return {};
    const StructureCrop crop = crop_structure(runs_, grid_.size[1], box, members);
    std::vector<ClassNormals> owned;
    for (const StructureClass& h : members) {
      if (is_owned(h)) owned.push_back({{h.id, runs_.classes[h.id]}, content_.boundary_normals[h.id]});
    }
    const auto visit = [&](const SmoothGradient& gradient, std::int64_t k) {
      for (ClassNormals& normals : owned) compare_normals(normals, crop, gradient, k);
    };
    const SurfaceMesh mesh = fit_surface(crop, grid_, rule.value_or(SurfaceRule::kVoxels), visit);
    if (mesh != content_.surfaces[s]) return {};
    return {*rule, static_cast<std::uint32_t>(mesh.positions_ijk.size()),
            static_cast<std::uint32_t>(mesh.triangles.size())};
  }

  [[nodiscard]] bool normals_are_fitted(ClassId c) const {
    return owners_[c] != kNoStructure && normals_differ_[c] == 0;
  }

 private:
  struct ClassNormals {
    RunsBySlice runs;
    std::span<const PackedNormal> left;  // of the voxels of `runs`
  };

  void compare_normals(ClassNormals& normals, const StructureCrop& crop, const SmoothGradient& gradient,
                       std::int64_t k) {
    normals.runs.visit_slice(k, crop, grid_.size[1], [&](std::int64_t i, std::int64_t j) {
      if (voxel_normals_.normal(gradient.at(i, j)) != normals.left.front())
        normals_differ_[normals.runs.id] = 1;
      normals.left = normals.left.subspan(1);
    });
  }

  const AtlasContent& content_;
  const RunModel& runs_;
  const Grid grid_;
  const VoxelNormals voxel_normals_;
  const StructureClasses structure_classes_;
  std::vector<StructureIndex> owners_;        // [class]
  std::vector<std::uint8_t> normals_differ_;  // [class]; bytes, for concurrent writes
};

}  // namespace

std::uint64_t crop_voxels(const IndexBox& box) {
  return around(box).voxels();  // cannot overflow: a valid box has at most 2^40 voxels, 2^24 per axis
}

FittedParts find_fitted_parts(const AtlasContent& content, const RunModel& runs, unsigned threads) {
  FitComparer comparer(content, runs);
  FittedParts parts;
  parts.surfaces.resize(content.graph.size());
  parallel_for(parts.surfaces.size(), threads, [&](std::size_t s) {
    parts.surfaces[s] = comparer.fitted_surface(static_cast<StructureIndex>(s));
  });
  for (ClassId c = 0; c < content.classes.size(); ++c)
    parts.normals.push_back(comparer.normals_are_fitted(c));
  return parts;
}

std::vector<bool> find_uniform(const ClassTable& classes, const StructureClasses& structure_classes,
                               std::size_t structures) {
  const auto holders_of = [&](const StructureClass& h) {
    std::vector<StructureIndex> holders;
    for (const Membership& m : classes.members(h.id)) {
      if (m.holds()) holders.push_back(m.structure);
    }
    return holders;
  };
  std::vector<bool> uniform(structures, true);
  for (StructureIndex s = 0; s < structures; ++s) {
    const std::span<const StructureClass> all = structure_classes.of(s);
    if (all.empty()) continue;
    const std::vector<StructureIndex> holders = holders_of(all.front());
    uniform[s] = std::ranges::all_of(all, [&](const StructureClass& h) { return holders_of(h) == holders; });
  }
  return uniform;
}

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

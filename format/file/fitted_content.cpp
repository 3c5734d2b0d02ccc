#include "format/file/fitted_content.h"

#include <algorithm>
#include <optional>

#include "format/derive/fit_surface.h"
#include "format/derive/structure_crop.h"
#include "format/tasks/parallel.h"

namespace splatlas {
namespace {

/// The rule that a surface may follow.
std::optional<SurfaceRule> rule_of(const SurfaceMesh& mesh, const Index3& size) {
  if (mesh.empty()) return std::nullopt;
  for (const SurfaceRule rule : {SurfaceRule::kVoxels, SurfaceRule::kSmooth}) {
    if (mesh.position_scale == static_cast<std::uint32_t>(rule) && rule_for(rule, size) == rule) return rule;
  }
  return std::nullopt;
}

/// Compares fitted surfaces and normals with those of the content.
class FitComparer {
 public:
  explicit FitComparer(const AtlasContent& content)
      : content_(content),
        grid_(storage_grid(content)),
        voxel_normals_(grid_),
        normal_at_(content.class_volume.size()),
        structure_classes_(content.classes, content.graph.size()),
        owners_(normal_owners(content.classes)),
        normals_differ_(content.classes.size(), 0) {
    std::vector<std::size_t> next(content.classes.size(), 0);
    for (std::size_t v = 0; v < normal_at_.size(); ++v) {
      const ClassId c = content.class_volume[v];
      if (owners_[c] != kNoStructure) normal_at_[v] = content.boundary_normals[c][next[c]++];
    }
  }

  /// Compares the surface, and the normals of the classes owned by s. Threads may process different
  /// structures concurrently, because each class has one owner.
  [[nodiscard]] bool surface_is_fitted(StructureIndex s) {
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
    if (!fits || (!rule && std::ranges::none_of(members, is_owned))) return false;
    const std::vector<std::uint8_t> parts = parts_of(members, owners_.size());
    const StructureCrop crop = crop_structure(content_.class_volume, grid_.size, box, parts);
    const auto visit = [&](const SmoothGradient& gradient, std::int64_t k) {
      compare_normals(s, crop, gradient, k);
    };
    const SurfaceMesh mesh = fit_surface(crop, grid_, rule.value_or(SurfaceRule::kVoxels), visit);
    return mesh == content_.surfaces[s];
  }

  [[nodiscard]] bool normals_are_fitted(ClassId c) const {
    return owners_[c] != kNoStructure && normals_differ_[c] == 0;
  }

 private:
  void compare_normals(StructureIndex s, const StructureCrop& crop, const SmoothGradient& gradient,
                       std::int64_t k) {
    for_each_voxel(crop, k, grid_, [&](std::int64_t i, std::int64_t j, std::size_t voxel) {
      const ClassId c = content_.class_volume[voxel];
      if (owners_[c] != s || normals_differ_[c] != 0) return;
      if (voxel_normals_.normal(gradient.at(i, j)) != normal_at_[voxel]) normals_differ_[c] = 1;
    });
  }

  const AtlasContent& content_;
  const Grid grid_;
  const VoxelNormals voxel_normals_;
  std::vector<PackedNormal> normal_at_;  // [voxel]
  const StructureClasses structure_classes_;
  std::vector<StructureIndex> owners_;        // [class]
  std::vector<std::uint8_t> normals_differ_;  // [class]; bytes, for concurrent writes
};

}  // namespace

std::uint64_t crop_voxels(const IndexBox& box) {
  std::uint64_t voxels = 1;
  // Cannot overflow: a valid box has at most 2^40 voxels, 2^24 per axis.
  for (std::size_t a = 0; a < 3; ++a)
    voxels *= static_cast<std::uint64_t>(box.last[a] - box.first[a] + 1 + 2 * SmoothGradient::kRadius);
  return voxels;
}

FittedParts find_fitted_parts(const AtlasContent& content, unsigned threads) {
  FitComparer comparer(content);
  std::vector<std::uint8_t> surfaces(content.graph.size(), 0);
  parallel_for(surfaces.size(), threads, [&](std::size_t s) {
    surfaces[s] = comparer.surface_is_fitted(static_cast<StructureIndex>(s));
  });
  FittedParts parts;
  parts.surfaces.assign(surfaces.begin(), surfaces.end());
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

}  // namespace splatlas

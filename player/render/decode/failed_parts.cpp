#include "player/render/decode/failed_parts.h"

#include <map>

#include "format/derive/value_groups.h"

namespace splatlas {
namespace {

/// Removes the classes of failed groups from a plan and its voxel counts, and adds them to `missing`.
void leave_out_groups(const std::map<std::uint32_t, Error>& failed, const ValueGroups& groups,
                      const ClassTable& classes, DrawPlan& plan,
                      std::map<StructureIndex, MissingPart>& missing) {
  std::erase_if(plan.classes, [&](const ClassDraw& draw) {
    const auto found = failed.find(groups.group_of[draw.id]);
    if (found == failed.end() || !draws_volume(draw.role)) return false;
    const std::uint64_t voxels = classes.voxels(draw.id);
    (draw.role == VoxelRole::kHybrid ? plan.hybrid_voxels : plan.volume_voxels) -= voxels;
    const auto [part, is_new] = missing.try_emplace(draw.volume_of);
    if (is_new) part->second = {draw.volume_of, false, 0, found->second};
    part->second.voxels += voxels;
    return true;
  });
}

}  // namespace

std::vector<MissingPart> leave_out(std::span<const FailedClass> failed_classes,
                                   std::span<const FailedSurface> failed_surfaces, const ClassTable& classes,
                                   DrawPlan& plan) {
  std::map<StructureIndex, MissingPart> volumes;
  if (!failed_classes.empty()) {
    const ValueGroups groups(classes);
    std::map<std::uint32_t, Error> failed;
    for (const FailedClass& of : failed_classes) failed.try_emplace(groups.group_of[of.id], of.error);
    leave_out_groups(failed, groups, classes, plan, volumes);
  }
  std::vector<MissingPart> missing;
  for (auto& [structure, part] : volumes) missing.push_back(std::move(part));
  for (const FailedSurface& of : failed_surfaces) {
    std::erase(plan.surfaces, of.structure);
    missing.push_back({of.structure, true, 0, of.error});
  }
  return missing;
}

}  // namespace splatlas

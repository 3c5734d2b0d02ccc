#include "player/frame/face_classes.h"

#include <tuple>

#include "player/transfer_function.h"

namespace splatlas {

std::vector<FaceClass> face_classes(const ClassTable& classes, const Selection& selection,
                                    const DrawPlan& plan) {
  std::vector<std::uint32_t> draw_of_class(classes.size(), FaceClass::kEveryVoxel);
  for (std::uint32_t n = 0; n < plan.classes.size(); ++n) {
    if (draws_volume(plan.classes[n].role)) draw_of_class[plan.classes[n].id] = n;
  }
  const auto draw_of = [&](StructureIndex s) {
    return s < selection.structures.size() ? selection.structures[s] : StructureDraw{};
  };
  std::vector<FaceClass> faces(classes.size());
  for (ClassId c = 0; c < classes.size(); ++c) {
    FaceClass& face = faces[c];
    std::uint32_t latest_term = 0;
    for (const Membership& member : classes.members(c)) {
      const StructureDraw draw = draw_of(member.structure);
      if (!member.holds() || draw.mode == DrawMode::kOff) continue;
      if (face.has_face() &&
          std::tuple(draw.term, member.structure) < std::tuple(latest_term, face.structure))
        continue;
      face.structure = member.structure;
      latest_term = draw.term;
    }
    if (!face.has_face()) continue;
    const StructureDraw draw = draw_of(face.structure);
    const bool is_solid = draw.mode != DrawMode::kVolume;
    face.opacity = is_solid ? draw.opacity.value_or(1.0f) : full_opacity(draw);
    face.color = {srgb_to_linear(draw.color.r), srgb_to_linear(draw.color.g), srgb_to_linear(draw.color.b)};
    if (is_solid) continue;
    face.draw = draw_of_class[c];
    if (face.draw == FaceClass::kEveryVoxel) face = {};  // a damaged part
  }
  return faces;
}

}  // namespace splatlas

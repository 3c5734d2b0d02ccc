#include "player/render/clip/face_classes.h"

#include "player/transfer_function.h"

namespace splatlas {

FaceStyle solid_style(StructureIndex structure, const Selection& selection) {
  const StructureDraw& draw = selection.structures[structure];
  return {structure,
          draw.term,
          draw.opacity.value_or(1.0f),
          {srgb_to_linear(draw.color.r), srgb_to_linear(draw.color.g), srgb_to_linear(draw.color.b)}};
}

FaceStyle face_style(StructureIndex structure, const Selection& selection) {
  const StructureDraw& draw = selection.structures[structure];
  if (draw.mode == DrawMode::kOff || (draw.mode == DrawMode::kSurface && draw.ghost)) return {};
  FaceStyle style = solid_style(structure, selection);
  if (!is_solid(draw)) style.opacity = full_opacity(draw);
  return style;
}

std::vector<FaceClass> face_classes(const ClassTable& classes, const Selection& selection,
                                    const DrawPlan& plan, const std::vector<bool>& without) {
  constexpr std::uint32_t kNotDrawn = FaceClass::kEveryVoxel;
  std::vector<std::uint32_t> draw_of_class(classes.size(), kNotDrawn);
  for (std::uint32_t n = 0; n < plan.classes.size(); ++n) {
    if (draws_volume(plan.classes[n].role)) draw_of_class[plan.classes[n].id] = n;
  }
  std::vector<FaceStyle> styles;
  for (StructureIndex s = 0; s < selection.structures.size(); ++s) {
    const bool is_left_out = s < without.size() && without[s];
    styles.push_back(is_left_out ? FaceStyle() : face_style(s, selection));
  }
  std::vector<FaceClass> faces(classes.size());
  for (ClassId c = 0; c < classes.size(); ++c) {
    FaceClass& face = faces[c];
    for (const Membership& member : classes.members(c)) {
      if (!member.holds() || member.structure >= styles.size()) continue;
      const FaceStyle& style = styles[member.structure];
      if (style.hides(face)) static_cast<FaceStyle&>(face) = style;
    }
    if (!face.has_face() || is_solid(selection.structures[face.structure])) continue;
    const std::uint32_t draw = draw_of_class[c];
    if (draw == kNotDrawn) {
      face = {};  // a damaged part
    } else if (plan.classes[draw].volume_of == face.structure) {
      face.draw = draw;
    }
  }
  return faces;
}

}  // namespace splatlas

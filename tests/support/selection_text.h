// Text of any selection.
#pragma once

#include <string>

#include <fmt/format.h>

#include "format/content/selection.h"

namespace splatlas {

/// Selection::parse() of it equals `selection` except for term numbers. Each structure has terms of its own,
/// after those of all above it; opacities must be above 0.
inline std::string text_of(const Selection& selection, const StructureGraph& graph) {
  std::string text = "* - *";
  for (const StructureIndex s : graph.topological()) {
    const StructureDraw& draw = selection.structures[s];
    text += fmt::format(" - \"{}\"", graph[s].id);
    if (draw.mode == DrawMode::kOff) continue;
    text += fmt::format(" + \"{}\":{}(color={}", graph[s].id, name_of(draw.mode), to_hex(draw.color));
    if (draw.ghost) text += ",ghost";
    if (draw.opacity) text += fmt::format(",opacity={}", *draw.opacity);
    const VolumeStyle& style = draw.volume;
    if (!style.curve) text += fmt::format(",profile={}", name_of(style.profile));
    if (style.low) text += fmt::format(",low={}", *style.low);
    if (style.high) text += fmt::format(",high={}", *style.high);
    for (std::size_t n = 0; style.curve && n < style.curve->points.size(); ++n) {
      const TransferPoint& point = style.curve->points[n];
      text += fmt::format("{}{}:{}:{}", n == 0 ? ",curve=" : "/", point.grey, point.opacity, point.shade);
    }
    text += ')';
  }
  return text;
}

}  // namespace splatlas

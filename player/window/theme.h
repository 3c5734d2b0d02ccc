// Fonts and colours of the window.
#pragma once

#include <imgui.h>

#include "format/content/color.h"

namespace splatlas {

struct Fonts {
  ImFont* regular = nullptr;
  ImFont* small = nullptr;  ///< for hints, units and table heads
  ImFont* large = nullptr;  ///< for the caption and the orientation letters
};

/// Sets style and fonts of the current ImGui context. `scale` is 1 at 96 dots per inch. Uses DejaVu Sans if
/// installed, otherwise ImGui's default font.
[[nodiscard]] Fonts apply_theme(float scale);

/// Converts sRGB to an ImGui colour.
[[nodiscard]] ImU32 ui_color(Rgb color, float alpha = 1.0f);

inline constexpr ImU32 kTextColor = IM_COL32(232, 234, 237, 255);
inline constexpr ImU32 kDimColor = IM_COL32(150, 156, 166, 255);
inline constexpr ImU32 kErrorColor = IM_COL32(255, 128, 112, 255);
inline constexpr ImU32 kAccentColor = IM_COL32(74, 144, 217, 255);
inline constexpr ImU32 kFaintAccentColor = IM_COL32(74, 144, 217, 90);

}  // namespace splatlas

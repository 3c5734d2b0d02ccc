#include "player/window/mode_buttons.h"

#include <array>

#include <imgui.h>

#include "player/window/theme.h"

namespace splatlas {
namespace {

struct ModeButton {
  DrawMode mode;
  const char* head;
  const char* hint;
};
constexpr std::array<ModeButton, 4> kButtons{
    ModeButton{DrawMode::kOff, "off", "Off: not drawn"},
    ModeButton{DrawMode::kVolume, "vol", "Volume: see into it"},
    ModeButton{DrawMode::kSurface, "surf", "Surface: its skin alone"},
    ModeButton{DrawMode::kBoth, "both", "Both: a skin around the volume"},
};

float button_width() {
  return ImGui::GetFontSize() * 2.1f;
}
/// Symbol of a mode. Off: a stroke; volume: a disc with a soft edge; surface: a ring; both: a ring around a
/// disc.
void draw_symbol(DrawMode mode, ImVec2 center, float radius, ImU32 color) {
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  const float line = radius * 0.3f;
  const auto faded = [color](float alpha) {
    ImVec4 value = ImGui::ColorConvertU32ToFloat4(color);
    value.w *= alpha;
    return ImGui::ColorConvertFloat4ToU32(value);
  };
  switch (mode) {
    case DrawMode::kOff:
      draw.AddLine({center.x - radius * 0.7f, center.y}, {center.x + radius * 0.7f, center.y}, color, line);
      break;
    case DrawMode::kVolume:
      draw.AddCircleFilled(center, radius, faded(0.35f));
      draw.AddCircleFilled(center, radius * 0.75f, faded(0.5f));
      draw.AddCircleFilled(center, radius * 0.5f, faded(0.8f));
      break;
    case DrawMode::kSurface: draw.AddCircle(center, radius - line / 2, color, 0, line); break;
    case DrawMode::kBoth:
      draw.AddCircle(center, radius - line / 2, color, 0, line);
      draw.AddCircleFilled(center, radius * 0.5f, color);
      break;
  }
}

}  // namespace

float mode_buttons_width() {
  return button_width() * static_cast<float>(kButtons.size());
}

void mode_buttons_head(ImFont* small) {
  const ImVec2 start = ImGui::GetCursorScreenPos();
  const float step = button_width();
  ImGui::PushFont(small);
  for (std::size_t n = 0; n < kButtons.size(); ++n) {
    const float width = ImGui::CalcTextSize(kButtons[n].head).x;
    const float x = start.x + step * (static_cast<float>(n) + 0.5f) - width / 2;
    ImGui::GetWindowDrawList()->AddText({x, start.y}, kDimColor, kButtons[n].head);
  }
  ImGui::PopFont();
  ImGui::Dummy({mode_buttons_width(), small->FontSize});
}

std::optional<DrawMode> mode_buttons(ModeSet modes, Rgb color, std::string_view row, LayoutLog& layout) {
  std::optional<DrawMode> clicked;
  const ImVec2 size{button_width(), ImGui::GetFontSize() * 1.5f};
  ImVec2 at = ImGui::GetCursorScreenPos();
  for (const ModeButton& button : kButtons) {
    ImGui::SetCursorScreenPos(at);
    if (ImGui::InvisibleButton(button.head, size)) clicked = button.mode;
    layout.row_item(row, name_of(button.mode));
    const bool hovered = ImGui::IsItemHovered();
    if (hovered) ImGui::SetTooltip("%s", button.hint);

    ImDrawList& draw = *ImGui::GetWindowDrawList();
    const ImVec2 min{at.x + 1, at.y + 1}, max{at.x + size.x - 1, at.y + size.y - 1};
    const float rounding = ImGui::GetStyle().FrameRounding;
    const bool some = modes.contains(button.mode), all = modes.is_only(button.mode);
    if (all) {
      draw.AddRectFilled(min, max, button.mode == DrawMode::kOff ? IM_COL32(70, 77, 89, 255) : kAccentColor,
                         rounding);
    } else if (some) {
      draw.AddRectFilled({min.x, (min.y + max.y) / 2}, max, kFaintAccentColor, rounding,
                         ImDrawFlags_RoundCornersBottom);
    }
    if (hovered) draw.AddRect(min, max, kDimColor, rounding);
    const ImU32 ink = all ? IM_COL32_WHITE : some ? ui_color(color) : IM_COL32(112, 119, 130, 255);
    draw_symbol(button.mode, {at.x + size.x / 2, at.y + size.y / 2}, size.y * 0.29f, ink);
    at.x += size.x;
  }
  return clicked;
}

}  // namespace splatlas

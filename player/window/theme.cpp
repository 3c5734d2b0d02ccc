#include "player/window/theme.h"

#include <array>
#include <filesystem>

namespace splatlas {
namespace {

constexpr const char* kFontFile = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";
constexpr float kRegularPixels = 16, kSmallPixels = 13, kLargePixels = 27;

/// Glyph ranges: Latin with diacritics, Greek, Cyrillic, general punctuation, arrows.
constexpr std::array<ImWchar, 13> kGlyphs{0x0020, 0x024f, 0x0370, 0x052f, 0x1e00, 0x1eff, 0x2010,
                                          0x205e, 0x2190, 0x21ff, 0xfffd, 0xfffd, 0};

ImFont* add_font(float pixels) {
  ImFontAtlas& fonts = *ImGui::GetIO().Fonts;
  std::error_code ignored;
  if (std::filesystem::exists(kFontFile, ignored)) {
    if (ImFont* font = fonts.AddFontFromFileTTF(kFontFile, pixels, nullptr, kGlyphs.data())) return font;
  }
  ImFontConfig config;
  config.SizePixels = pixels;
  return fonts.AddFontDefault(&config);
}

ImVec4 rgb(int r, int g, int b) {
  return ImGui::ColorConvertU32ToFloat4(IM_COL32(r, g, b, 255));
}

void set_colors(ImVec4* colors) {
  colors[ImGuiCol_Text] = ImGui::ColorConvertU32ToFloat4(kTextColor);
  colors[ImGuiCol_TextDisabled] = ImGui::ColorConvertU32ToFloat4(kDimColor);
  colors[ImGuiCol_WindowBg] = rgb(27, 30, 35);
  colors[ImGuiCol_ChildBg] = rgb(27, 30, 35);
  colors[ImGuiCol_PopupBg] = rgb(36, 40, 47);
  colors[ImGuiCol_Border] = rgb(58, 64, 74);
  colors[ImGuiCol_FrameBg] = rgb(42, 47, 55);
  colors[ImGuiCol_FrameBgHovered] = rgb(52, 59, 69);
  colors[ImGuiCol_FrameBgActive] = rgb(60, 68, 80);
  colors[ImGuiCol_Button] = rgb(48, 54, 64);
  colors[ImGuiCol_ButtonHovered] = rgb(62, 72, 86);
  colors[ImGuiCol_ButtonActive] = rgb(74, 144, 217);
  colors[ImGuiCol_Header] = rgb(48, 60, 76);
  colors[ImGuiCol_HeaderHovered] = rgb(56, 72, 92);
  colors[ImGuiCol_HeaderActive] = rgb(64, 86, 112);
  colors[ImGuiCol_SliderGrab] = rgb(74, 144, 217);
  colors[ImGuiCol_SliderGrabActive] = rgb(110, 172, 236);
  colors[ImGuiCol_ScrollbarBg] = rgb(27, 30, 35);
  colors[ImGuiCol_Separator] = rgb(58, 64, 74);
}

}  // namespace

Fonts apply_theme(float scale) {
  ImGui::StyleColorsDark();
  ImGuiStyle& style = ImGui::GetStyle();
  style.WindowPadding = {10, 10};
  style.FramePadding = {9, 5};
  style.ItemSpacing = {8, 7};
  style.FrameRounding = 4;
  style.GrabRounding = 4;
  style.PopupRounding = 4;
  style.ScrollbarRounding = 4;
  style.WindowBorderSize = 0;
  style.ChildBorderSize = 0;
  style.ScaleAllSizes(scale);
  set_colors(style.Colors);
  return {add_font(kRegularPixels * scale), add_font(kSmallPixels * scale), add_font(kLargePixels * scale)};
}

ImU32 ui_color(Rgb color, float alpha) {
  return IM_COL32(color.r, color.g, color.b, static_cast<int>(255 * alpha));
}

}  // namespace splatlas

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

}  // namespace

Fonts apply_theme(float scale) {
  ImGui::StyleColorsDark();
  ImGuiStyle& style = ImGui::GetStyle();
  style.WindowBorderSize = style.ChildBorderSize = 0;
  style.Colors[ImGuiCol_Text] = ImGui::ColorConvertU32ToFloat4(kTextColor);
  style.Colors[ImGuiCol_TextDisabled] = ImGui::ColorConvertU32ToFloat4(kDimColor);
  style.ScaleAllSizes(scale);
  return {add_font(kRegularPixels * scale), add_font(kSmallPixels * scale), add_font(kLargePixels * scale)};
}

ImU32 ui_color(Rgb color, float alpha) {
  return IM_COL32(color.r, color.g, color.b, static_cast<int>(255 * alpha));
}

}  // namespace splatlas

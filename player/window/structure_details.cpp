#include "player/window/structure_details.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "player/transfer_function.h"

namespace splatlas {
namespace {

/// Decimal digits in groups of three: "12 345 678".
std::string grouped(std::uint64_t number) {
  if (number < 1000) return std::to_string(number);
  return fmt::format("{} {:03}", grouped(number / 1000), number % 1000);
}

void facts_lines(const StructureFacts& facts) {
  const std::string sizes = fmt::format("{} voxels, {} triangles, {:.3g} ml", grouped(facts.voxels),
                                        grouped(facts.triangles), facts.millilitres);
  ImGui::TextDisabled("%s", sizes.c_str());
  std::string where = facts.paths.empty() ? std::string() : facts.paths.front();
  if (facts.paths.size() > 1) where += fmt::format("  (+{})", facts.paths.size() - 1);
  ImGui::TextDisabled("%s", where.c_str());
  if (ImGui::IsItemHovered() && !facts.paths.empty()) {
    ImGui::BeginTooltip();
    for (const std::string& path : facts.paths) ImGui::TextUnformatted(path.c_str());
    ImGui::EndTooltip();
  }
}

void opacity_control(SelectionEditor& editor, StructureIndex s,
                     const std::optional<StructureDraw>& appearance, LayoutLog& layout) {
  const bool surface = appearance && appearance->mode == DrawMode::kSurface;
  const bool is_default = !appearance || !appearance->opacity;
  float opacity = !is_default ? *appearance->opacity
                  : surface   ? 1.0f
                              : full_opacity(appearance.value_or(StructureDraw{}));
  ImGui::AlignTextToFramePadding();
  ImGui::TextDisabled("Opacity");
  ImGui::SameLine();
  const float others = ImGui::GetFrameHeight() + ImGui::CalcTextSize("Default").x +
                       2 * ImGui::GetStyle().FramePadding.x + 2 * ImGui::GetStyle().ItemSpacing.x;
  ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x - others);
  if (ImGui::SliderFloat("##opacity", &opacity, 0.01f, 1.0f, "%.2f",
                         ImGuiSliderFlags_AlwaysClamp | ImGuiSliderFlags_Logarithmic)) {
    editor.set_opacity(s, std::round(opacity * 100) / 100);
  }
  layout.item("opacity");
  if (ImGui::IsItemDeactivatedAfterEdit()) editor.end_gesture();
  ImGui::SameLine();
  ImGui::BeginDisabled(is_default);
  if (ImGui::Button("Default")) {
    editor.set_opacity(s, std::nullopt);
    editor.end_gesture();
  }
  ImGui::EndDisabled();
}

void color_control(SelectionEditor& editor, StructureIndex s, Rgb color) {
  std::array<float, 3> rgb{static_cast<float>(color.r) / 255, static_cast<float>(color.g) / 255,
                           static_cast<float>(color.b) / 255};
  if (ImGui::ColorEdit3("##color", rgb.data(), ImGuiColorEditFlags_NoInputs)) {
    const auto byte = [](float c) {
      return static_cast<std::uint8_t>(std::lround(255 * std::clamp(c, 0.0f, 1.0f)));
    };
    editor.set_color(s, {byte(rgb[0]), byte(rgb[1]), byte(rgb[2])});
  }
  if (ImGui::IsItemDeactivatedAfterEdit()) editor.end_gesture();
}

/// Controls of opacity and colour; disabled if the structure is off.
void appearance_controls(Session& session, StructureIndex s, LayoutLog& layout) {
  const auto appearance = session.editor().appearance(s);
  ImGui::BeginDisabled(!appearance);
  opacity_control(session.editor(), s, appearance, layout);
  ImGui::SameLine();
  color_control(session.editor(), s, appearance ? appearance->color : session.graph()[s].color);
  ImGui::EndDisabled();
}

void action_buttons(Session& session, StructureIndex s, LayoutLog& layout) {
  if (ImGui::Button("Isolate")) session.editor().isolate(s);
  layout.item("isolate");
  ImGui::SameLine();
  if (ImGui::Button("Ghost the others")) session.editor().ghost_others(s);
  layout.item("ghost");
  ImGui::SameLine();
  if (ImGui::Button("Hide")) session.editor().set_mode(s, DrawMode::kOff);
  layout.item("hide");
}

}  // namespace

float structure_details_height() {
  const ImGuiStyle& style = ImGui::GetStyle();
  return 3 * ImGui::GetTextLineHeightWithSpacing() + 2 * ImGui::GetFrameHeightWithSpacing() +
         style.ItemSpacing.y * 2;
}

void structure_details(Session& session, const Fonts& fonts, LayoutLog& layout) {
  ImGui::Separator();
  if (!session.current()) {
    ImGui::TextDisabled("Click a structure, here or in the picture.");
    return;
  }
  const StructureFacts facts = *session.current();
  ImGui::TextUnformatted(session.graph()[facts.structure].name.c_str());
  ImGui::PushFont(fonts.small);
  facts_lines(facts);
  ImGui::PopFont();
  appearance_controls(session, facts.structure, layout);
  action_buttons(session, facts.structure, layout);
}

}  // namespace splatlas

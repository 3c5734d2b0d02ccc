#include "player/window/structure_panel.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "player/transfer_function.h"
#include "player/window/mode_buttons.h"

namespace splatlas {
namespace {

constexpr std::size_t kMaxSearchBytes = 128;

void search_field(Session& session, UiState& ui, LayoutLog& layout) {
  std::array<char, kMaxSearchBytes> text{};
  session.rows().search_text().copy(text.data(), text.size() - 1);
  if (std::exchange(ui.focus_search, false)) ImGui::SetKeyboardFocusHere();
  ImGui::SetNextItemWidth(-FLT_MIN);
  const bool edited =
      ImGui::InputTextWithHint("##search", "Search structures  ( / )", text.data(), text.size());
  layout.item("search");
  if (edited) session.rows().search(text.data());
}

void whole_atlas_buttons(Session& session, LayoutLog& layout) {
  SelectionEditor& editor = session.editor();
  if (layout.button("Show all", "show_all")) editor.show_all();
  ImGui::SameLine();
  if (layout.button("Hide all", "hide_all")) editor.hide_all();
  ImGui::SameLine(0, ImGui::GetFontSize() * 1.5f);
  ImGui::BeginDisabled(!editor.can_undo());
  if (layout.button("Undo", "undo")) editor.undo();
  ImGui::EndDisabled();
  ImGui::SameLine();
  ImGui::BeginDisabled(!editor.can_redo());
  if (layout.button("Redo", "redo")) editor.redo();
  ImGui::EndDisabled();
}

void draw_arrow(ImVec2 center, float radius, bool open) {
  const float r = radius;
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  if (open) {
    draw.AddTriangleFilled({center.x - r, center.y - r * 0.6f}, {center.x + r, center.y - r * 0.6f},
                           {center.x, center.y + r * 0.8f}, kDimColor);
  } else {
    draw.AddTriangleFilled({center.x - r * 0.6f, center.y - r}, {center.x + r * 0.8f, center.y},
                           {center.x - r * 0.6f, center.y + r}, kDimColor);
  }
}

/// Draws text up to `right`. Longer text ends in an ellipsis and is shown in full as a tooltip.
void draw_name(const std::string& name, ImVec2 at, float right, ImU32 color, bool hovered) {
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  const float room = right - at.x;
  if (ImGui::CalcTextSize(name.c_str()).x <= room) {
    draw.AddText(at, color, name.c_str());
    return;
  }
  const char* rest = nullptr;
  const float dots = ImGui::CalcTextSize("...").x;
  const float width =
      ImGui::GetFont()
          ->CalcTextSizeA(ImGui::GetFontSize(), std::max(1.0f, room - dots), 0, name.c_str(), nullptr, &rest)
          .x;
  draw.AddText(at, color, name.c_str(), rest);
  draw.AddText({at.x + width, at.y}, kDimColor, "...");
  if (hovered) ImGui::SetTooltip("%s", name.c_str());
}

void row_menu(Session& session, StructureIndex s) {
  if (!ImGui::BeginPopupContextItem("menu")) return;
  ImGui::TextDisabled("%s", session.graph()[s].name.c_str());
  if (ImGui::MenuItem("Isolate")) session.editor().isolate(s);
  if (ImGui::MenuItem("Ghost the others")) session.editor().ghost_others(s);
  if (ImGui::MenuItem("Hide")) session.editor().set_mode(s, DrawMode::kOff);
  ImGui::EndPopup();
}

class Tree {
 public:
  Tree(Session& session, LayoutLog& layout) : session_(session), layout_(layout) {}

  void draw() {
    if (const auto row = session_.take_revealed_row()) scroll_to(*row);
    std::optional<StructureRow> toggled;
    const std::vector<StructureRow>& rows = session_.rows().rows();
    ImGuiListClipper clipper;
    clipper.Begin(static_cast<int>(rows.size()), row_height());
    while (clipper.Step()) {
      for (int n = clipper.DisplayStart; n < clipper.DisplayEnd; ++n) {
        const StructureRow& row = rows[static_cast<std::size_t>(n)];
        if (draw_row(row)) toggled = row;
      }
    }
    if (toggled) session_.rows().toggle(*toggled);
    if (rows.empty()) ImGui::TextDisabled("Nothing is called that.");
  }

  [[nodiscard]] static float row_height() { return ImGui::GetFontSize() * 1.5f; }

 private:
  static void scroll_to(std::size_t row) {
    const float top = static_cast<float>(row) * row_height();
    const float seen = ImGui::GetScrollY(), room = ImGui::GetWindowHeight() - 2 * row_height();
    if (top < seen || top > seen + room) ImGui::SetScrollY(std::max(0.0f, top - room / 2));
  }

  /// Draws a row. Returns true if the user toggles its branch.
  bool draw_row(const StructureRow& row) {
    const Structure& structure = session_.graph()[row.structure];
    const ModeSet modes = session_.editor().modes(row.structure);
    ImGui::PushID(reinterpret_cast<const void*>(row.place));  // NOLINT(performance-no-int-to-ptr): a number
    const ImVec2 start = ImGui::GetCursorScreenPos();
    const float height = row_height();
    // Reserve the width of the scrollbar, so that the buttons do not move.
    const float buttons_x = ImGui::GetWindowPos().x + ImGui::GetWindowWidth() -
                            ImGui::GetStyle().ScrollbarSize - mode_buttons_width();
    const float arrow_x = start.x + static_cast<float>(row.depth) * ImGui::GetFontSize();
    const float name_x = arrow_x + ImGui::GetFontSize() * 1.3f;

    bool toggled = draw_branch_arrow(row, {arrow_x, start.y});
    ImGui::SetCursorScreenPos({name_x, start.y});
    ImGui::InvisibleButton("name", {std::max(1.0f, buttons_x - name_x - 4), height});
    layout_.row_item(structure.id, "name");
    const bool hovered = ImGui::IsItemHovered();
    if (ImGui::IsItemClicked()) session_.choose(row.structure, false);
    if (hovered && ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left)) toggled = row.has_children;
    row_menu(session_, row.structure);
    draw_label(row.structure, {name_x, start.y}, buttons_x - 6, hovered);

    ImGui::SetCursorScreenPos({buttons_x, start.y});
    if (const auto mode = mode_buttons(modes, structure.color, structure.id, layout_)) {
      session_.editor().set_mode(row.structure, *mode);
    }
    ImGui::SetCursorScreenPos({start.x, start.y + height});
    ImGui::PopID();
    return toggled;
  }

  bool draw_branch_arrow(const StructureRow& row, ImVec2 at) {
    if (!row.has_children || session_.rows().searching()) return false;
    const float side = ImGui::GetFontSize();
    ImGui::SetCursorScreenPos(at);
    const bool clicked = ImGui::InvisibleButton("arrow", {side * 1.2f, row_height()});
    layout_.row_item(session_.graph()[row.structure].id, "arrow");
    draw_arrow({at.x + side * 0.55f, at.y + row_height() / 2}, side * 0.3f, row.open);
    return clicked;
  }

  /// Draws colour and name: dimmed if the structure is off, highlighted if it is current or hovered.
  void draw_label(StructureIndex s, ImVec2 at, float right, bool hovered) {
    const Structure& structure = session_.graph()[s];
    const ModeSet modes = session_.editor().modes(s);
    const float side = ImGui::GetFontSize() * 0.72f, height = row_height();
    ImDrawList& draw = *ImGui::GetWindowDrawList();
    const bool current = session_.current() && session_.current()->structure == s;
    const bool under_pointer = session_.hovered() == s;
    if (current || under_pointer || hovered) {
      const ImU32 color = current         ? ImGui::GetColorU32(ImGuiCol_HeaderActive)
                          : under_pointer ? ImGui::GetColorU32(ImGuiCol_HeaderHovered)
                                          : ImGui::GetColorU32(ImGuiCol_FrameBg);
      draw.AddRectFilled({at.x - 3, at.y + 1}, {right + 3, at.y + height - 1}, color, 3);
    }
    const bool off = modes.is_only(DrawMode::kOff);
    const float top = at.y + (height - side) / 2;
    draw.AddRectFilled({at.x, top}, {at.x + side, top + side}, ui_color(structure.color, off ? 0.35f : 1.0f),
                       3);
    const float text_y = at.y + (height - ImGui::GetFontSize()) / 2;
    draw_name(structure.name, {at.x + side * 1.6f, text_y}, right, off ? kDimColor : kTextColor, hovered);
  }

  Session& session_;
  LayoutLog& layout_;
};

/// Line above the tree with the number of structures or matches, and the heads of the mode buttons.
void table_head(Session& session, const Fonts& fonts) {
  const std::string text = session.rows().searching() ? fmt::format("{} found", session.rows().rows().size())
                                                      : fmt::format("{} structures", session.graph().size());
  const ImGuiStyle& style = ImGui::GetStyle();
  ImGui::PushFont(fonts.small);
  ImGui::TextDisabled("%s", text.c_str());
  ImGui::PopFont();
  ImGui::SameLine(ImGui::GetWindowWidth() - style.WindowPadding.x - style.ScrollbarSize -
                  mode_buttons_width());
  mode_buttons_head(fonts.small);
}

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
  if (layout.button("Isolate", "isolate")) session.editor().isolate(s);
  ImGui::SameLine();
  if (layout.button("Ghost the others", "ghost")) session.editor().ghost_others(s);
  ImGui::SameLine();
  if (layout.button("Hide", "hide")) session.editor().set_mode(s, DrawMode::kOff);
}

/// Height of structure_details(), constant so that the tree above it does not move.
float structure_details_height() {
  const ImGuiStyle& style = ImGui::GetStyle();
  return 3 * ImGui::GetTextLineHeightWithSpacing() + 2 * ImGui::GetFrameHeightWithSpacing() +
         style.ItemSpacing.y * 2;
}

/// Facts and controls of the current structure.
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

}  // namespace

void structure_panel(Session& session, UiState& ui, const Fonts& fonts, LayoutLog& layout) {
  search_field(session, ui, layout);
  whole_atlas_buttons(session, layout);
  table_head(session, fonts);
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {0, 0});
  if (ImGui::BeginChild("tree", {0, -structure_details_height()})) {
    Tree(session, layout).draw();
  }
  ImGui::EndChild();
  ImGui::PopStyleVar();
  structure_details(session, fonts, layout);
}

}  // namespace splatlas

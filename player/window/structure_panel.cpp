#include "player/window/structure_panel.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

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
  if (ImGui::Button("Show all")) editor.show_all();
  layout.item("show_all");
  ImGui::SameLine();
  if (ImGui::Button("Hide all")) editor.hide_all();
  layout.item("hide_all");
  ImGui::SameLine(0, ImGui::GetFontSize() * 1.5f);
  ImGui::BeginDisabled(!editor.can_undo());
  if (ImGui::Button("Undo")) editor.undo();
  layout.item("undo");
  ImGui::EndDisabled();
  ImGui::SameLine();
  ImGui::BeginDisabled(!editor.can_redo());
  if (ImGui::Button("Redo")) editor.redo();
  layout.item("redo");
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

}  // namespace

void structure_panel(Session& session, UiState& ui, const Fonts& fonts, LayoutLog& layout,
                     float height_below) {
  search_field(session, ui, layout);
  whole_atlas_buttons(session, layout);
  table_head(session, fonts);
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {0, 0});
  if (ImGui::BeginChild("tree", {0, -height_below})) {
    Tree(session, layout).draw();
  }
  ImGui::EndChild();
  ImGui::PopStyleVar();
}

}  // namespace splatlas

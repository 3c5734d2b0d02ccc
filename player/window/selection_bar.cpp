#include "player/window/selection_bar.h"

#include <imgui_stdlib.h>

namespace splatlas {
namespace {

constexpr const char* kHints =
    "drag: turn     shift+drag: move     wheel: zoom     A P L R S I: views     F: fit     /: search    "
    " "
    "Ctrl+Z: undo     F1: all keys";

void message_line(const Session& session, const Fonts& fonts) {
  const bool text_error = !session.text_error().empty();
  const std::string& text = text_error ? session.text_error() : session.status().text;
  ImGui::PushFont(fonts.small);
  if (text.empty()) {
    ImGui::TextDisabled("%s", kHints);
  } else {
    const bool error = text_error || session.status().error;
    ImGui::PushStyleColor(ImGuiCol_Text, error ? kErrorColor : kTextColor);
    ImGui::TextUnformatted(text.c_str());
    ImGui::PopStyleColor();
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", text.c_str());
  }
  ImGui::PopFont();
}

}  // namespace

float SelectionBar::height() {
  return ImGui::GetFrameHeightWithSpacing() + ImGui::GetTextLineHeight();
}

void SelectionBar::draw(Session& session, UiState& ui, const Fonts& fonts, LayoutLog& layout) {
  if (version_ != session.editor().version()) {
    version_ = session.editor().version();
    typed_ = session.editor().text();
  }
  ImGui::AlignTextToFramePadding();
  ImGui::TextDisabled("Selection");
  ImGui::SameLine();
  const ImGuiStyle& style = ImGui::GetStyle();
  const float buttons = ImGui::CalcTextSize("Apply").x + ImGui::CalcTextSize("Copy").x +
                        4 * style.FramePadding.x + 2 * style.ItemSpacing.x;
  ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x - buttons);
  if (std::exchange(ui.focus_text, false)) ImGui::SetKeyboardFocusHere();
  bool apply = ImGui::InputText("##selection", &typed_, ImGuiInputTextFlags_EnterReturnsTrue);
  layout.item("text");
  ImGui::SameLine();
  apply |= layout.button("Apply", "apply");
  if (apply) session.apply_text(typed_);
  ImGui::SameLine();
  if (layout.button("Copy", "copy")) {
    ImGui::SetClipboardText(session.editor().text().c_str());
    session.set_status({"The selection text is in the clipboard.", false});
  }
  message_line(session, fonts);
}

}  // namespace splatlas

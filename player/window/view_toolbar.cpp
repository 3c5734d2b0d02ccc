#include "player/window/view_toolbar.h"

#include "player/window/theme.h"
#include "player/window/view_names.h"

namespace splatlas {

void view_toolbar(Session& session, UiState& ui, LayoutLog& layout) {
  const auto current = view_of(session.camera());
  for (const NamedView view : {NamedView::kAnterior, NamedView::kPosterior, NamedView::kLeft,
                               NamedView::kRight, NamedView::kSuperior, NamedView::kInferior}) {
    const std::string title(title_of(view));
    const bool active = current == view;
    if (active) ImGui::PushStyleColor(ImGuiCol_Button, kAccentColor);
    if (ImGui::Button(title.c_str())) session.appearance_from(view);
    if (active) ImGui::PopStyleColor();
    layout.item(title);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("key %c", title.front());
    ImGui::SameLine();
  }
  ImGui::SameLine(0, ImGui::GetFontSize());
  if (ImGui::Button("Reset")) session.reset_view();
  layout.item("reset");
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("first view, everything in the picture (Home)");
  ImGui::SameLine();
  bool edges = session.depth_cue() == DepthCue::kEdges;
  if (ImGui::Checkbox("Depth", &edges)) session.set_depth_cue(edges ? DepthCue::kEdges : DepthCue::kNone);
  layout.item("depth");
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("darker behind what is near, and in furrows (D)");

  const ImGuiStyle& style = ImGui::GetStyle();
  const float save = ImGui::CalcTextSize("Save picture").x + 2 * style.FramePadding.x;
  const float help = ImGui::CalcTextSize("Help").x + 2 * style.FramePadding.x;
  ImGui::SameLine();
  const float room = ImGui::GetContentRegionAvail().x - save - help - style.ItemSpacing.x;
  if (room > 0) ImGui::SetCursorPosX(ImGui::GetCursorPosX() + room);
  if (ImGui::Button("Save picture")) session.save_picture();
  layout.item("save");
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("as PNG beside the atlas (Ctrl+S)");
  ImGui::SameLine();
  if (ImGui::Button("Help")) ui.show_help = !ui.show_help;
  layout.item("help");
}

}  // namespace splatlas

#include "player/window/view_panel.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <SDL_opengl.h>
#include <fmt/format.h>

#include "player/camera_moves.h"
#include "player/window/session/view_names.h"

namespace splatlas {
namespace {

constexpr double kWheelZoom = 1.15;
constexpr ImU32 kLetterColor = IM_COL32(255, 214, 120, 230);

/// Area of the view: top left corner and size in window coordinates, and size in pixels.
struct ViewArea {
  ImVec2 min, size;
  PictureSize pixels;

  [[nodiscard]] ImVec2 max() const { return {min.x + size.x, min.y + size.y}; }
  [[nodiscard]] double pixels_per_unit() const { return pixels.width / static_cast<double>(size.x); }
};

/// Area at the cursor, aligned to whole pixels so that pictures need no resampling.
ViewArea area_here(float height_below) {
  const ImVec2 room = ImGui::GetContentRegionAvail(), start = ImGui::GetCursorScreenPos();
  const ImVec2 scale = ImGui::GetIO().DisplayFramebufferScale;
  const auto whole = [](float length, float pixels_per_unit) {
    return std::max(1.0f, std::floor(length * pixels_per_unit));
  };
  ViewArea area;
  area.pixels = {std::min(static_cast<int>(whole(room.x, scale.x)), kMaxPictureSide),
                 std::min(static_cast<int>(whole(room.y - height_below, scale.y)), kMaxPictureSide)};
  area.min = {std::floor(start.x * scale.x) / scale.x, std::floor(start.y * scale.y) / scale.y};
  area.size = {static_cast<float>(area.pixels.width) / scale.x,
               static_cast<float>(area.pixels.height) / scale.y};
  return area;
}

/// True if the pointer has moved beyond the drag threshold since the button was pressed.
bool has_travelled(ImGuiMouseButton button) {
  const ImGuiIO& io = ImGui::GetIO();
  const float x = io.MousePos.x - io.MouseClickedPos[button].x;
  const float y = io.MousePos.y - io.MouseClickedPos[button].y;
  return std::max(io.MouseDragMaxDistanceSqr[button], x * x + y * y) >=
         io.MouseDragThreshold * io.MouseDragThreshold;
}

/// True during a drag, and in the frame of the release, which may include the last motion.
bool is_dragged(ImGuiMouseButton button) {
  return ImGui::IsMouseDragging(button) || (ImGui::IsMouseReleased(button) && has_travelled(button));
}

/// Orbits or pans the camera during a drag. Returns true during a drag.
bool drag(Session& session, const ViewArea& area) {
  const ImGuiIO& io = ImGui::GetIO();
  const double scale = area.pixels_per_unit();
  const double dx = io.MouseDelta.x * scale, dy = io.MouseDelta.y * scale;
  const bool left = is_dragged(ImGuiMouseButton_Left);
  const bool other = is_dragged(ImGuiMouseButton_Right) || is_dragged(ImGuiMouseButton_Middle);
  if (other || (left && io.KeyShift)) {
    session.set_camera(moved_by_drag(session.camera(), dx, dy, area.pixels, session.atlas().display()));
  } else if (left) {
    session.set_camera(turned_by_drag(session.camera(), dx, dy, area.pixels));
  }
  return left || other;
}

void mouse(Session& session, const ViewArea& area) {
  ImGui::InvisibleButton("view", area.size,
                         ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight |
                             ImGuiButtonFlags_MouseButtonMiddle);
  const bool dragging = (ImGui::IsItemActive() || ImGui::IsItemDeactivated()) && drag(session, area);
  const bool hovered = ImGui::IsItemHovered();
  const ImGuiIO& io = ImGui::GetIO();
  const ViewPoint point{(io.MousePos.x - area.min.x) / static_cast<double>(area.size.x),
                        (io.MousePos.y - area.min.y) / static_cast<double>(area.size.y)};
  session.point_at(hovered && !dragging ? std::optional(point) : std::nullopt);
  if (!hovered) return;
  if (ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left)) {
    session.frame_at(point);
  } else if (ImGui::IsMouseReleased(ImGuiMouseButton_Left) && !has_travelled(ImGuiMouseButton_Left) &&
             io.MouseClickedLastCount[ImGuiMouseButton_Left] == 1) {
    session.click_at(point);
  }
  if (io.MouseWheel != 0) {
    session.set_camera(zoomed_at(session.camera(), std::pow(kWheelZoom, io.MouseWheel),
                                 point.u * area.pixels.width, point.v * area.pixels.height, area.pixels,
                                 session.atlas().display()));
  }
}

/// Draws the picture centred and scaled to fit, until one of the new size is rendered.
void draw_picture(const DisplayFrame* frame, unsigned texture, const ViewArea& area) {
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  draw.AddRectFilled(area.min, area.max(), IM_COL32_BLACK);
  if (frame == nullptr) return;
  const PictureSize& size = frame->request.size;
  const float scale =
      std::min(area.size.x / static_cast<float>(size.width), area.size.y / static_cast<float>(size.height));
  const ImVec2 half{static_cast<float>(size.width) * scale / 2, static_cast<float>(size.height) * scale / 2};
  const ImVec2 middle{area.min.x + area.size.x / 2, area.min.y + area.size.y / 2};
  const auto id =
      reinterpret_cast<ImTextureID>(std::uintptr_t{texture});  // NOLINT(performance-no-int-to-ptr)
  draw.AddImage(id, {middle.x - half.x, middle.y - half.y}, {middle.x + half.x, middle.y + half.y});
}

/// Draws text with an outline, readable over any picture.
void draw_over_picture(ImVec2 at, ImU32 color, const std::string& text) {
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  const float shadow = std::max(1.0f, ImGui::GetFontSize() / 14);
  for (const ImVec2 offset : {ImVec2{-shadow, 0}, ImVec2{shadow, 0}, ImVec2{0, -shadow}, ImVec2{0, shadow}}) {
    draw.AddText({at.x + offset.x, at.y + offset.y}, IM_COL32(0, 0, 0, 200), text.c_str());
  }
  draw.AddText(at, color, text.c_str());
}

/// Draws anatomical orientation letters at the four edges.
void draw_letters(const Session& session, const ViewArea& area, const Fonts& fonts) {
  const auto view = parallel_view(session.camera(), area.pixels, session.atlas().display());
  if (!view) return;
  const auto opposite = [](const Vec3& v) { return Vec3{-v[0], -v[1], -v[2]}; };
  ImGui::PushFont(fonts.large);
  const float edge = ImGui::GetFontSize() * 0.5f;
  const ImVec2 middle{area.min.x + area.size.x / 2, area.min.y + area.size.y / 2}, max = area.max();
  const auto letters = [&](const Vec3& direction, float x_share, float y_share, ImVec2 at) {
    const std::string text = direction_letters(direction);
    const ImVec2 size = ImGui::CalcTextSize(text.c_str());
    draw_over_picture({at.x - size.x * x_share, at.y - size.y * y_share}, kLetterColor, text);
  };
  letters(view->right_lps, 1, 0.5f, {max.x - edge, middle.y});
  letters(opposite(view->right_lps), 0, 0.5f, {area.min.x + edge, middle.y});
  letters(view->up_lps, 0.5f, 0, {middle.x, area.min.y + edge * 0.5f});
  letters(opposite(view->up_lps), 0.5f, 1, {middle.x, max.y - edge * 0.5f});
  ImGui::PopFont();
}

/// Draws the view's name or angles at the top left, and the progress of refinement at the top right.
void draw_view_state(const Session& session, const ViewArea& area) {
  const Camera& camera = session.camera();
  const float gap = ImGui::GetFontSize() * 0.8f;
  const auto view = view_of(camera);
  std::string text =
      view ? fmt::format("{} view", title_of(*view))
           : fmt::format("azimuth {:.0f}, elevation {:.0f}", camera.azimuth_deg, camera.elevation_deg);
  if (std::abs(session.zoom() - 1) > 0.005) text += fmt::format(", zoom {:.2f}", session.zoom());
  draw_over_picture({area.min.x + gap, area.min.y + gap}, kDimColor, text);
  if (!session.refining()) return;
  const std::string mark = session.frame() ? "refining ..." : "reading ...";
  const float width = ImGui::CalcTextSize(mark.c_str()).x;
  draw_over_picture({area.max().x - gap - width, area.min.y + gap}, kLetterColor, mark);
}

/// Draws number, name and caption of the scene at the bottom left.
void draw_scene(const Session& session, const ViewArea& area, const Fonts& fonts) {
  if (!session.scene()) return;
  const std::vector<Scene>& scenes = session.atlas().scenes();
  const Scene& scene = scenes[*session.scene()];
  std::string text = fmt::format("{}/{}  {}", *session.scene() + 1, scenes.size(), scene.name);
  const std::string& line = session.asks() ? scene.question : scene.caption;
  if (!line.empty()) text += "\n" + line;
  ImGui::PushFont(fonts.large);
  const float gap = ImGui::GetFontSize() * 0.5f, width = area.size.x - 2 * gap;
  const float height = ImGui::CalcTextSize(text.c_str(), nullptr, false, width).y;
  const ImVec2 at{area.min.x + gap, area.max().y - gap - height};
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  draw.AddRectFilled({area.min.x, at.y - gap / 2}, area.max(), IM_COL32(0, 0, 0, 225));
  draw.AddText(nullptr, 0, at, IM_COL32_WHITE, text.c_str(), nullptr, width);
  ImGui::PopFont();
}

float caption_height(const Fonts& fonts) {
  return fonts.large->FontSize * 1.25f;
}

/// Draws name and path of the structure under the pointer, below the picture.
void draw_caption(const Session& session, const ViewArea& area, const Fonts& fonts) {
  const float height = caption_height(fonts), side = fonts.large->FontSize * 0.7f;
  const ImVec2 start{area.min.x, area.max().y};
  ImGui::SetCursorScreenPos(start);
  ImGui::Dummy({area.size.x, height});
  if (!session.hovered()) return;
  const Structure& structure = session.graph()[*session.hovered()];
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  ImGui::PushClipRect(start, {area.max().x, start.y + height}, true);
  const float top = start.y + (height - side) / 2;
  draw.AddRectFilled({start.x, top}, {start.x + side, top + side}, ui_color(structure.color), 4);
  ImGui::PushFont(fonts.large);
  const ImVec2 name_at{start.x + side * 1.5f, start.y + (height - ImGui::GetFontSize()) / 2};
  const float name_width = ImGui::CalcTextSize(structure.name.c_str()).x;
  draw.AddText(name_at, IM_COL32_WHITE, structure.name.c_str());
  ImGui::PopFont();
  const auto paths = session.graph().paths(*session.hovered(), 1);
  if (!paths.empty() && paths.front() != structure.name) {
    const float gap = ImGui::GetFontSize() * 1.2f;
    draw.AddText({name_at.x + name_width + gap, start.y + (height - ImGui::GetFontSize()) / 2}, kDimColor,
                 paths.front().c_str());
  }
  ImGui::PopClipRect();
}

/// A button with a text that explains it. True when it is pressed.
bool button(LayoutLog& layout, const char* title, const char* name, const char* tip) {
  const bool pressed = layout.button(title, name);
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", tip);
  return pressed;
}

/// Draws one line to choose a scene, if the atlas has any.
void scene_bar(Session& session, LayoutLog& layout) {
  const std::vector<Scene>& scenes = session.atlas().scenes();
  if (scenes.empty()) return;
  if (button(layout, "<", "scene_before", "scene before (Page up)")) session.show_scene_before();
  ImGui::SameLine();
  if (button(layout, ">", "next_scene", "next scene (Page down)")) session.show_next_scene();
  ImGui::SameLine();
  ImGui::SetNextItemWidth(ImGui::GetFontSize() * 24);
  const bool open =
      ImGui::BeginCombo("##scenes", session.scene() ? scenes[*session.scene()].name.c_str() : "Scenes");
  layout.item("scenes");
  if (!open) return;
  for (std::size_t n = 0; n < scenes.size(); ++n) {
    ImGui::PushID(static_cast<int>(n));
    if (ImGui::Selectable(scenes[n].name.c_str(), session.scene() == n)) session.show_scene(n);
    ImGui::PopID();
  }
  ImGui::EndCombo();
}

/// Draws one line of buttons: standard views, reset, save, help.
void view_toolbar(Session& session, UiState& ui, LayoutLog& layout) {
  const auto current = view_of(session.camera());
  for (const NamedView view : kNamedViews) {
    const std::string title(title_of(view));
    const bool active = current == view;
    if (active) ImGui::PushStyleColor(ImGuiCol_Button, kAccentColor);
    if (layout.button(title.c_str(), title)) session.turn_to(view);
    if (active) ImGui::PopStyleColor();
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("key %c", title.front());
    ImGui::SameLine();
  }
  ImGui::SameLine(0, ImGui::GetFontSize());
  if (button(layout, "Reset", "reset", "first view, fitted to the selection (Home)")) session.reset_view();
  ImGui::SameLine();
  if (button(layout, "Fit", "fit", "the selection fills the picture (F)")) session.frame_selection();
  ImGui::SameLine();
  bool edges = session.depth_cue() == DepthCue::kEdges;
  if (ImGui::Checkbox("Depth", &edges)) session.set_depth_cue(edges ? DepthCue::kEdges : DepthCue::kNone);
  layout.item("depth");
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("depth darkening (D)");

  const ImGuiStyle& style = ImGui::GetStyle();
  const float save = ImGui::CalcTextSize("Save picture").x + 2 * style.FramePadding.x;
  const float help = ImGui::CalcTextSize("Help").x + 2 * style.FramePadding.x;
  ImGui::SameLine();
  const float room = ImGui::GetContentRegionAvail().x - save - help - style.ItemSpacing.x;
  if (room > 0) ImGui::SetCursorPosX(ImGui::GetCursorPosX() + room);
  if (button(layout, "Save picture", "save", "as PNG beside the atlas (Ctrl+S)")) session.save_picture();
  ImGui::SameLine();
  if (layout.button("Help", "help")) ui.show_help = !ui.show_help;
}

}  // namespace

ViewPanel::~ViewPanel() {
  if (texture_ != 0) glDeleteTextures(1, &texture_);
}

/// Uploads the frame if it has changed.
void ViewPanel::upload(const std::shared_ptr<const DisplayFrame>& frame) {
  if (frame == frame_) return;
  frame_ = frame;
  if (!frame_) return;
  if (texture_ == 0) glGenTextures(1, &texture_);
  glBindTexture(GL_TEXTURE_2D, texture_);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB, frame_->size.width, frame_->size.height, 0, GL_RGB, GL_UNSIGNED_BYTE,
               frame_->srgb8.data());
}

void ViewPanel::draw(Session& session, UiState& ui, const Fonts& fonts, LayoutLog& layout,
                     float height_below) {
  view_toolbar(session, ui, layout);
  scene_bar(session, layout);
  const ViewArea area = area_here(height_below + caption_height(fonts));
  session.resize(area.pixels);
  layout.area("view", area.min, area.max());
  mouse(session, area);
  upload(session.frame());
  ImGui::PushClipRect(area.min, area.max(), true);
  draw_picture(frame_.get(), texture_, area);
  draw_letters(session, area, fonts);
  draw_view_state(session, area);
  draw_scene(session, area, fonts);
  ImGui::PopClipRect();
  draw_caption(session, area, fonts);
}

}  // namespace splatlas

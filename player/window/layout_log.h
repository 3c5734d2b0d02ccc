// Log of screen positions, for scripts that simulate the mouse.
#pragma once

#include <string>
#include <string_view>

#include <imgui.h>
#include <nlohmann/json.hpp>

#include "player/window/session/session_log.h"

namespace splatlas {

/// Collects the positions of items in a frame, in window coordinates. Logs them as an event "layout" when
/// they change. Does nothing if the session log is off.
class LayoutLog {
 public:
  explicit LayoutLog(const SessionLog& log) : log_(log) {}

  /// Records the centre of the latest ImGui item.
  void item(std::string_view name) {
    if (log_.on()) layout_[std::string(name)] = middle_of_item();
  }
  /// Draws a button, and records its centre. Returns true if it is clicked.
  bool button(const char* title, std::string_view name) {
    const bool clicked = ImGui::Button(title);
    item(name);
    return clicked;
  }
  /// Records a rectangle as [x, y, width, height].
  void area(std::string_view name, ImVec2 min, ImVec2 max) {
    if (log_.on()) layout_[std::string(name)] = {min.x, min.y, max.x - min.x, max.y - min.y};
  }
  /// Records the latest ImGui item as `part` of a tree row ("off", "volume", ..., "name", "arrow").
  void row_item(std::string_view row, std::string_view part) {
    if (log_.on()) layout_["rows"][std::string(row)][std::string(part)] = middle_of_item();
  }

  void finish() {
    if (log_.on() && layout_ != logged_) log_.write("layout", logged_ = layout_);
    layout_ = nlohmann::ordered_json::object();
  }

 private:
  static nlohmann::ordered_json middle_of_item() {
    const ImVec2 min = ImGui::GetItemRectMin(), max = ImGui::GetItemRectMax();
    return {static_cast<int>((min.x + max.x) / 2), static_cast<int>((min.y + max.y) / 2)};
  }

  const SessionLog& log_;
  nlohmann::ordered_json layout_ = nlohmann::ordered_json::object(), logged_;
};

}  // namespace splatlas

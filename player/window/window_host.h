// Window host: SDL2, OpenGL and ImGui's backends.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include <SDL.h>

#include "format/result.h"

namespace splatlas {

/// Window with an OpenGL context and a current ImGui context. At most one exists at a time. Main thread only,
/// except for wake().
class WindowHost {
 public:
  /// Opens a window. kFailed without a display or OpenGL.
  [[nodiscard]] static Result<std::unique_ptr<WindowHost>> open(const std::string& title);
  ~WindowHost();
  WindowHost(const WindowHost&) = delete;
  WindowHost& operator=(const WindowHost&) = delete;

  /// Scale of fonts and paddings: dots per inch / 96, from 1 to 3.
  [[nodiscard]] float ui_scale() const { return ui_scale_; }

  /// Waits for events, at most `timeout_ms` (-1: no limit). Passes each event to `take`, and to ImGui if
  /// `take` returns false. Stops after an event that needs a frame of its own, so that ImGui sees each press
  /// at its position. Returns true if there were events.
  bool wait(int timeout_ms, const std::function<bool(const SDL_Event&)>& take);
  /// Ends a wait(). Thread-safe.
  void wake() const;

  /// Starts an ImGui frame.
  void begin_frame();
  /// Renders the ImGui frame and presents it.
  void end_frame();

 private:
  WindowHost() = default;
  [[nodiscard]] Result<void> start(const std::string& title);
  void follow_pointer(const SDL_Event& event);

  SDL_Window* window_ = nullptr;
  SDL_GLContext context_ = nullptr;
  bool sdl_ = false, imgui_ = false, imgui_sdl_ = false, imgui_gl_ = false;
  Uint32 wake_event_ = 0;
  float ui_scale_ = 1;
  std::optional<SDL_Point> pointer_;  // none: the pointer is outside the window
};

}  // namespace splatlas

// The operating system's side of the window: SDL2, OpenGL and ImGui's backends.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include <SDL.h>

#include "format/result.h"

namespace splatlas {

/// A window with an OpenGL context and a current ImGui context, closed in the right order. One at a time; for
/// the main thread, but for wake().
class WindowHost {
 public:
  /// kFailed when there is no display or no OpenGL.
  [[nodiscard]] static Result<std::unique_ptr<WindowHost>> open(const std::string& title);
  ~WindowHost();
  WindowHost(const WindowHost&) = delete;
  WindowHost& operator=(const WindowHost&) = delete;

  /// Dots per inch over 96, at least 1: what fonts and paddings are multiplied by.
  [[nodiscard]] float ui_scale() const { return ui_scale_; }

  /// Sleeps until something happens or `timeout_ms` have passed (-1: for ever). Offers what has happened to
  /// `take`, and what that does not take (false) to ImGui: up to where a frame has to be drawn, so that
  /// however much has happened while the last one was drawn, no press is lost and each happens where it was
  /// made. Returns whether anything has happened.
  bool wait(int timeout_ms, const std::function<bool(const SDL_Event&)>& take);
  /// Ends a wait(). For any thread.
  void wake() const;

  void begin_frame();
  /// Draws what ImGui has collected and shows it.
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
  std::optional<SDL_Point> pointer_;  // none: outside the window
};

}  // namespace splatlas

// Virtual display (Xvfb) with a simulated mouse and keyboard (xdotool).
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <sys/types.h>

namespace splatlas {

/// An Xvfb server at a free display number, which DISPLAY names during its lifetime. Throws
/// std::runtime_error on failures.
class VirtualDisplay {
 public:
  VirtualDisplay();
  /// Also ends programs with windows on it.
  ~VirtualDisplay();
  VirtualDisplay(const VirtualDisplay&) = delete;
  VirtualDisplay& operator=(const VirtualDisplay&) = delete;

  /// Waits for a window of this title and makes it the target of the calls below.
  void find_window(const std::string& title);

  /// Runs xdotool with these arguments.
  void xdotool(const std::vector<std::string>& words);
  /// Moves the pointer to (x, y) of the window.
  void point(int x, int y);
  void click(int x, int y);
  /// Presses the left button at `from`, moves to `to` in steps and releases it.
  void drag(std::array<int, 2> from, std::array<int, 2> to);
  void key(const std::string& key) { xdotool({"key", key}); }
  void type(const std::string& text) { xdotool({"type", "--delay", "20", text}); }
  void resize(int width, int height);

  /// Red, green and blue on screen at (x, y) of the window.
  [[nodiscard]] std::array<std::uint8_t, 3> pixel(int x, int y);
  /// The text of the clipboard.
  [[nodiscard]] std::string clipboard();
  /// Sends the close request of a window manager.
  void request_close();

 private:
  struct Connection;

  pid_t server_ = -1;
  std::unique_ptr<Connection> connection_;
  unsigned long window_ = 0;
};

}  // namespace splatlas

// A display without a screen (Xvfb), a mouse and a keyboard without hands (xdotool).
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <sys/types.h>

namespace splatlas {

/// An Xvfb of its own at a free display number, which DISPLAY names while it lives. Throws std::runtime_error
/// when it cannot do what it is asked for.
class VirtualDisplay {
 public:
  VirtualDisplay();
  /// Also ends what still has a window on it.
  ~VirtualDisplay();
  VirtualDisplay(const VirtualDisplay&) = delete;
  VirtualDisplay& operator=(const VirtualDisplay&) = delete;

  /// Waits for a window with this title and makes it the one that everything below is about.
  void find_window(const std::string& title);

  /// Runs xdotool with these words.
  void xdotool(const std::vector<std::string>& words);
  /// Moves the pointer to (x, y) of the window.
  void point(int x, int y);
  void click(int x, int y);
  /// Presses the left button at `from`, moves to `to` in steps as a hand does, lets go.
  void drag(std::array<int, 2> from, std::array<int, 2> to);
  void key(const std::string& key) { xdotool({"key", key}); }
  void type(const std::string& text) { xdotool({"type", "--delay", "20", text}); }
  void resize(int width, int height);

  /// Red, green, blue on screen at (x, y) of the window.
  [[nodiscard]] std::array<std::uint8_t, 3> pixel(int x, int y);
  /// What another program would paste.
  [[nodiscard]] std::string clipboard();
  /// What a window manager does when the user closes a window: asks it to.
  void request_close();

 private:
  struct Connection;

  pid_t server_ = -1;
  std::unique_ptr<Connection> connection_;
  unsigned long window_ = 0;
};

}  // namespace splatlas

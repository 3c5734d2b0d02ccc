// Virtual display (Xvfb) with a simulated mouse and keyboard (xdotool).
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <sys/types.h>

namespace splatlas {

/// Calls attempt() until it returns true. Throws std::runtime_error with what() after a minute.
template <typename Attempt, typename What>
void wait_until(const Attempt& attempt, const What& what) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::minutes(1);
  while (!attempt()) {
    if (std::chrono::steady_clock::now() > deadline) throw std::runtime_error("waited in vain for " + what());
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

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

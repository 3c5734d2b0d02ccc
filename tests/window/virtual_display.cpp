#include "tests/window/virtual_display.h"

#include <cstdlib>
#include <stdexcept>

#include <X11/Xlib.h>
#include <X11/Xutil.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/run_program.h"
#include "tests/support/xvfb.h"

namespace splatlas {
struct VirtualDisplay::Connection {
  Connection() : display(XOpenDisplay(nullptr)) {
    if (display == nullptr) throw std::runtime_error("the virtual display does not answer");
  }
  ~Connection() { XCloseDisplay(display); }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  [[nodiscard]] Atom atom(const char* name) const { return XInternAtom(display, name, False); }

  Display* display;
};

VirtualDisplay::VirtualDisplay() {
  const XvfbServer server = start_xvfb(SPLATLAS_XVFB, "1400x900x24");
  server_ = server.process;
  if (server.display.empty()) throw std::runtime_error("Xvfb does not start");
  setenv("DISPLAY", server.display.c_str(), 1);
  unsetenv("WAYLAND_DISPLAY");
  connection_ = std::make_unique<Connection>();
}

VirtualDisplay::~VirtualDisplay() {
  connection_.reset();
  stop_xvfb(server_);
  unsetenv("DISPLAY");
}

void VirtualDisplay::find_window(const std::string& title) {
  const auto find = [&] {
    const ProgramResult found = run_program({SPLATLAS_XDOTOOL, "search", "--onlyvisible", "--name", title});
    if (found.status == 0) window_ = std::stoul(found.out);
    return found.status == 0;
  };
  wait_until(find, [&] { return "a window called " + title; });
}

void VirtualDisplay::xdotool(const std::vector<std::string>& words) {
  std::vector<std::string> command{SPLATLAS_XDOTOOL};
  command.insert(command.end(), words.begin(), words.end());
  const ProgramResult result = run_program(command);
  if (result.status != 0) throw std::runtime_error("xdotool: " + result.err);
}

void VirtualDisplay::point(int x, int y) {
  xdotool({"mousemove", "--window", std::to_string(window_), std::to_string(x), std::to_string(y)});
}

void VirtualDisplay::click(int x, int y) {
  point(x, y);
  xdotool({"click", "1"});
}

void VirtualDisplay::drag(std::array<int, 2> from, std::array<int, 2> to) {
  constexpr int kSteps = 8;
  point(from[0], from[1]);
  xdotool({"mousedown", "1"});
  for (int n = 1; n <= kSteps; ++n) {
    point(from[0] + (to[0] - from[0]) * n / kSteps, from[1] + (to[1] - from[1]) * n / kSteps);
  }
  xdotool({"mouseup", "1"});
}

void VirtualDisplay::resize(int width, int height) {
  xdotool({"windowsize", std::to_string(window_), std::to_string(width), std::to_string(height)});
}

std::array<std::uint8_t, 3> VirtualDisplay::pixel(int x, int y) {
  XImage* image = XGetImage(connection_->display, window_, x, y, 1, 1, AllPlanes, ZPixmap);
  if (image == nullptr) throw std::runtime_error("cannot read the screen");
  const unsigned long value = XGetPixel(image, 0, 0);
  XDestroyImage(image);
  const auto byte = [value](int shift) { return static_cast<std::uint8_t>(value >> shift & 0xff); };
  return {byte(16), byte(8), byte(0)};
}

std::string VirtualDisplay::clipboard() {
  Display* display = connection_->display;
  const Window reader = XCreateSimpleWindow(display, DefaultRootWindow(display), 0, 0, 1, 1, 0, 0, 0);
  const Atom place = connection_->atom("SPLATLAS_TEST"), text = connection_->atom("UTF8_STRING");
  XConvertSelection(display, connection_->atom("CLIPBOARD"), text, place, reader, CurrentTime);
  XEvent event;
  wait_until([&] { return XCheckTypedWindowEvent(display, reader, SelectionNotify, &event) == True; },
             [] { return std::string("the clipboard"); });
  Atom type = None;
  int format = 0;
  unsigned long items = 0, left = 0;
  unsigned char* bytes = nullptr;
  XGetWindowProperty(display, reader, place, 0, 4096, False, text, &type, &format, &items, &left, &bytes);
  std::string result;
  if (bytes != nullptr) {
    result.assign(bytes, bytes + items);
    XFree(bytes);
  }
  XDestroyWindow(display, reader);
  return result;
}

void VirtualDisplay::request_close() {
  XEvent event{};
  event.xclient.type = ClientMessage;
  event.xclient.window = window_;
  event.xclient.message_type = connection_->atom("WM_PROTOCOLS");
  event.xclient.format = 32;
  event.xclient.data.l[0] = static_cast<long>(connection_->atom("WM_DELETE_WINDOW"));
  XSendEvent(connection_->display, window_, False, NoEventMask, &event);
  XFlush(connection_->display);
}

}  // namespace splatlas

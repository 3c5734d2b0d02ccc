#include "bench/peers/x_server.h"

#include <cstdlib>

#include "tests/support/xvfb.h"

namespace splatlas {

Result<XServer> start_x_server() {
  if (std::getenv("DISPLAY") != nullptr) return XServer();
  const XvfbServer server = start_xvfb("Xvfb", "1280x1280x24");
  XServer started(nullptr, [process = server.process](const void*) {
    stop_xvfb(process);
    unsetenv("DISPLAY");
  });
  if (server.display.empty()) {
    return fail(ErrorCode::kFailed, "Xvfb does not start; install Debian's package xvfb, or set DISPLAY");
  }
  setenv("DISPLAY", server.display.c_str(), 1);
  return started;
}

}  // namespace splatlas

#include "bench/peers/x_server.h"

#include <cstdlib>
#include <utility>

#include "tests/support/xvfb.h"

namespace splatlas {

Result<XServer> XServer::start_unless_there_is_one() {
  if (std::getenv("DISPLAY") != nullptr) return XServer(-1);
  const XvfbServer server = start_xvfb("Xvfb", "1280x1280x24");
  XServer started(server.process);
  if (server.display.empty()) {
    return fail(ErrorCode::kFailed, "Xvfb does not start; install Debian's package xvfb, or set DISPLAY");
  }
  setenv("DISPLAY", server.display.c_str(), 1);
  return started;
}

XServer::~XServer() {
  if (server_ < 0) return;
  stop_xvfb(server_);
  unsetenv("DISPLAY");
}

XServer::XServer(XServer&& other) noexcept : server_(std::exchange(other.server_, -1)) {}
XServer& XServer::operator=(XServer&& other) noexcept {
  std::swap(server_, other.server_);
  return *this;
}

}  // namespace splatlas

// A display for VTK, which draws nowhere without one.
#pragma once

#include <sys/types.h>

#include "format/result.h"

namespace splatlas {

/// Xvfb (Debian's package xvfb) at a free display number, which DISPLAY names while it lives. One at a time.
class XServer {
 public:
  /// Starts nothing where DISPLAY is set already. kFailed when there is no Xvfb.
  [[nodiscard]] static Result<XServer> start_unless_there_is_one();
  ~XServer();
  XServer(XServer&& other) noexcept;
  XServer& operator=(XServer&& other) noexcept;

 private:
  explicit XServer(pid_t server) : server_(server) {}
  pid_t server_;  // -1: not ours
};

}  // namespace splatlas

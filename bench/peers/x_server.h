// Virtual X display for VTK, which cannot draw without one.
#pragma once

#include <sys/types.h>

#include "format/result.h"

namespace splatlas {

/// Xvfb (Debian package xvfb) at a free display number, which DISPLAY names during its lifetime. One instance
/// at a time.
class XServer {
 public:
  /// Starts nothing if DISPLAY is set. kFailed without Xvfb.
  [[nodiscard]] static Result<XServer> start_unless_there_is_one();
  ~XServer();
  XServer(XServer&& other) noexcept;
  XServer& operator=(XServer&& other) noexcept;

 private:
  explicit XServer(pid_t server) : server_(server) {}
  pid_t server_;  // -1: not started
};

}  // namespace splatlas

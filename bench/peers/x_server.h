// Virtual X display for VTK, which cannot draw without one.
#pragma once

#include <memory>

#include "format/result.h"

namespace splatlas {

/// Ends Xvfb, which DISPLAY names until then.
using XServer = std::shared_ptr<const void>;

/// Starts Xvfb (Debian package xvfb) at a free display number; once at a time. Starts nothing if DISPLAY is
/// set. kFailed without Xvfb.
[[nodiscard]] Result<XServer> start_x_server();

}  // namespace splatlas

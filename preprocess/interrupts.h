// Ctrl-C and kill leave nothing half-written behind.
#pragma once

#include <filesystem>

namespace splatlas {

/// From now on SIGINT, SIGTERM and SIGHUP wait for DeferInterrupts, remove what RemoveOnInterrupt names, and
/// then end the program as they always do. For programs; libraries only mark what needs it.
void install_interrupt_handlers();

/// Interrupts wait while one of these exists.
class DeferInterrupts {
 public:
  DeferInterrupts();
  ~DeferInterrupts();
  DeferInterrupts(const DeferInterrupts&) = delete;
  DeferInterrupts& operator=(const DeferInterrupts&) = delete;
};

/// An interrupt removes this file while this exists. One at a time, paths of up to 4095 bytes.
class RemoveOnInterrupt {
 public:
  explicit RemoveOnInterrupt(const std::filesystem::path& path);
  ~RemoveOnInterrupt();
  RemoveOnInterrupt(const RemoveOnInterrupt&) = delete;
  RemoveOnInterrupt& operator=(const RemoveOnInterrupt&) = delete;
};

}  // namespace splatlas

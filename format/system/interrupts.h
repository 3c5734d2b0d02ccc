// Ctrl-C and kill leave nothing half-written behind.
#pragma once

#include <cstddef>
#include <filesystem>

namespace splatlas {

/// From now on SIGINT, SIGTERM and SIGHUP wait for DeferInterrupts, remove what RemoveOnInterrupt names, and
/// then end the program as they always do. A signal that the program was started to ignore (nohup) stays
/// ignored. A file that would grow beyond the process's limit (SIGXFSZ) is a write that fails. For programs;
/// libraries only mark what needs it.
void install_interrupt_handlers();

/// Interrupts wait while one of these exists, on any thread.
class DeferInterrupts {
 public:
  DeferInterrupts();
  ~DeferInterrupts();
  DeferInterrupts(const DeferInterrupts&) = delete;
  DeferInterrupts& operator=(const DeferInterrupts&) = delete;
};

/// Whether an interrupt waits for the last DeferInterrupts: long work ends early, and cleans up.
[[nodiscard]] bool interrupt_waits();

/// An interrupt removes this file while this exists. For up to 16 files at once, with paths of up to 4095
/// bytes; others are left. Any thread.
class RemoveOnInterrupt {
 public:
  explicit RemoveOnInterrupt(const std::filesystem::path& path);
  ~RemoveOnInterrupt();
  RemoveOnInterrupt(const RemoveOnInterrupt&) = delete;
  RemoveOnInterrupt& operator=(const RemoveOnInterrupt&) = delete;

 private:
  std::size_t slot_;
};

}  // namespace splatlas

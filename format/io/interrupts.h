// Signal handling: cleanup of unfinished output on SIGINT, SIGTERM and SIGHUP.
#pragma once

#include <cstddef>
#include <string>

namespace splatlas {

/// Installs handlers for SIGINT, SIGTERM and SIGHUP: they wait for DeferInterrupts, remove the files of
/// RemoveOnInterrupt and end the program with the default action. Ignored signals (nohup) stay ignored. Also
/// ignores SIGXFSZ, so that writes beyond the file size limit fail. Only for programs, not for libraries.
void install_interrupt_handlers();

/// Defers interrupts during its lifetime, on all threads.
class DeferInterrupts {
 public:
  DeferInterrupts();
  ~DeferInterrupts();
  DeferInterrupts(const DeferInterrupts&) = delete;
  DeferInterrupts& operator=(const DeferInterrupts&) = delete;
};

/// True if a deferred interrupt is pending. Long operations should then stop early and clean up.
[[nodiscard]] bool interrupt_waits();

/// Removes the name of an open file in an open folder, unless the name is of another file meanwhile. Safe in
/// signal handlers.
void remove_file_named(int folder, const char* name, int file);

/// Removes a file on interrupts during its lifetime, as remove_file_named() does. Supports 16 files at a time
/// with names of up to 255 bytes; others are not removed. Thread-safe.
class RemoveOnInterrupt {
 public:
  /// The descriptors must stay open during the lifetime.
  RemoveOnInterrupt(int folder, const std::string& name, int file);
  ~RemoveOnInterrupt();
  RemoveOnInterrupt(const RemoveOnInterrupt&) = delete;
  RemoveOnInterrupt& operator=(const RemoveOnInterrupt&) = delete;

 private:
  std::size_t slot_;
};

}  // namespace splatlas

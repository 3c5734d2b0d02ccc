#include "format/io/interrupts.h"

#include <array>
#include <atomic>
#include <csignal>
#include <cstring>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace splatlas {
namespace {

// Signal handlers may access only lock-free atomics and plain bytes guarded by them.
std::atomic<int> deferred{0};
std::atomic<int> waiting_signal{0};

struct FileToRemove {
  std::atomic<bool> taken{false};
  std::atomic<bool> named{false};
  std::array<char, 256> name{};
  int folder = -1, file = -1;
};
std::array<FileToRemove, 16> files_to_remove;

void end_by(int signal) {
  for (const FileToRemove& file : files_to_remove) {
    if (file.named) remove_file_named(file.folder, file.name.data(), file.file);
  }
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

extern "C" void handle_interrupt(int signal) {
  if (deferred > 0) {
    waiting_signal = signal;
  } else {
    end_by(signal);
  }
}

}  // namespace

void install_interrupt_handlers() {
  struct sigaction action {};
  action.sa_handler = handle_interrupt;
  action.sa_flags = SA_RESTART | SA_NODEFER;
  sigemptyset(&action.sa_mask);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction before {};
    if (sigaction(signal, nullptr, &before) == 0 && before.sa_handler == SIG_IGN) continue;
    sigaction(signal, &action, nullptr);
  }
  // Beyond the file size limit (ulimit -f), writes fail instead of ending the process.
  std::signal(SIGXFSZ, SIG_IGN);
}

DeferInterrupts::DeferInterrupts() {
  ++deferred;
}

DeferInterrupts::~DeferInterrupts() {
  if (--deferred > 0) return;
  if (const int signal = waiting_signal.exchange(0); signal != 0) end_by(signal);
}

bool interrupt_waits() {
  return waiting_signal != 0;
}

void remove_file_named(int folder, const char* name, int file) {
  struct stat open {
  }, named{};
  if (::fstat(file, &open) != 0 || ::fstatat(folder, name, &named, AT_SYMLINK_NOFOLLOW) != 0) return;
  if (open.st_dev == named.st_dev && open.st_ino == named.st_ino) ::unlinkat(folder, name, 0);
}

RemoveOnInterrupt::RemoveOnInterrupt(int folder, const std::string& name, int file)
    : slot_(files_to_remove.size()) {
  if (name.size() >= files_to_remove.front().name.size()) return;
  for (slot_ = 0; slot_ < files_to_remove.size(); ++slot_) {
    FileToRemove& to_remove = files_to_remove[slot_];
    if (to_remove.taken.exchange(true)) continue;
    std::memcpy(to_remove.name.data(), name.c_str(), name.size() + 1);
    to_remove.folder = folder;
    to_remove.file = file;
    to_remove.named = true;
    return;
  }
}

RemoveOnInterrupt::~RemoveOnInterrupt() {
  if (slot_ == files_to_remove.size()) return;
  files_to_remove[slot_].named = false;
  files_to_remove[slot_].taken = false;
}

}  // namespace splatlas

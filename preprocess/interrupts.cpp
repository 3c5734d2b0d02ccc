#include "preprocess/interrupts.h"

#include <array>
#include <atomic>
#include <csignal>
#include <cstring>

#include <unistd.h>

namespace splatlas {
namespace {

// A signal handler may touch lock-free atomics and plain bytes that they guard, nothing else.
std::atomic<int> deferred{0};
std::atomic<int> waiting_signal{0};
std::atomic<bool> has_file{false};
std::array<char, 4096> file_to_remove{};

void end_by(int signal) {
  if (has_file) ::unlink(file_to_remove.data());
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
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaction(signal, &action, nullptr);
}

DeferInterrupts::DeferInterrupts() {
  ++deferred;
}

DeferInterrupts::~DeferInterrupts() {
  if (--deferred > 0) return;
  if (const int signal = waiting_signal.exchange(0); signal != 0) end_by(signal);
}

RemoveOnInterrupt::RemoveOnInterrupt(const std::filesystem::path& path) {
  const std::string& bytes = path.native();
  if (bytes.size() >= file_to_remove.size()) return;
  std::memcpy(file_to_remove.data(), bytes.c_str(), bytes.size() + 1);
  has_file = true;
}

RemoveOnInterrupt::~RemoveOnInterrupt() {
  has_file = false;
}

}  // namespace splatlas

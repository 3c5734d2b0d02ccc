#include "bench/peers/x_server.h"

#include <array>
#include <csignal>
#include <cstdlib>
#include <string>
#include <utility>

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace splatlas {
namespace {

/// Xvfb chooses a free display, writes its number to `number_fd`, and ends with this process, however that
/// ends.
[[noreturn]] void become_server(int number_fd) {
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  const std::string fd = std::to_string(number_fd);
  execlp("Xvfb", "Xvfb", "-displayfd", fd.c_str(), "-screen", "0", "1280x1280x24", "-noreset", "-nolisten",
         "tcp", nullptr);
  _exit(127);
}

std::string read_line(int fd) {
  std::string line;
  char c = 0;
  while (read(fd, &c, 1) == 1 && c != '\n') line += c;
  return line;
}

}  // namespace

Result<XServer> XServer::start_unless_there_is_one() {
  if (std::getenv("DISPLAY") != nullptr) return XServer(-1);
  std::array<int, 2> number{};
  if (pipe(number.data()) != 0) return fail(ErrorCode::kFailed, "Xvfb: no pipe to be had to talk to it");
  const pid_t server = fork();
  if (server == 0) {
    close(number[0]);
    become_server(number[1]);
  }
  close(number[1]);
  const std::string display = read_line(number[0]);
  close(number[0]);
  XServer started(server);
  if (server < 0 || display.empty()) {
    return fail(ErrorCode::kFailed, "Xvfb does not start; install Debian's package xvfb, or set DISPLAY");
  }
  setenv("DISPLAY", (":" + display).c_str(), 1);
  return started;
}

XServer::~XServer() {
  if (server_ < 0) return;
  kill(server_, SIGTERM);
  waitpid(server_, nullptr, 0);
  unsetenv("DISPLAY");
}

XServer::XServer(XServer&& other) noexcept : server_(std::exchange(other.server_, -1)) {}
XServer& XServer::operator=(XServer&& other) noexcept {
  std::swap(server_, other.server_);
  return *this;
}

}  // namespace splatlas

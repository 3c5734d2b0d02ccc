// Xvfb server process.
#pragma once

#include <array>
#include <csignal>
#include <string>

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace splatlas {

struct XvfbServer {
  pid_t process = -1;
  std::string display;  ///< ":7"; empty if the server did not start
};

/// Starts Xvfb on a free display with one screen, such as "1280x1280x24". The server ends with this process
/// at the latest.
inline XvfbServer start_xvfb(const char* program, const char* screen) {
  std::array<int, 2> number{};
  if (pipe(number.data()) != 0) return {};
  XvfbServer server{fork(), ""};
  if (server.process == 0) {
    close(number[0]);
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    const std::string fd = std::to_string(number[1]);
    execlp(program, "Xvfb", "-displayfd", fd.c_str(), "-screen", "0", screen, "-noreset", "-nolisten", "tcp",
           nullptr);
    _exit(127);
  }
  close(number[1]);
  char c = 0;
  while (read(number[0], &c, 1) == 1 && c != '\n') server.display += c;
  close(number[0]);
  if (!server.display.empty()) server.display.insert(0, ":");
  return server;
}

inline void stop_xvfb(pid_t process) {
  if (process < 0) return;
  kill(process, SIGTERM);
  waitpid(process, nullptr, 0);
}

}  // namespace splatlas

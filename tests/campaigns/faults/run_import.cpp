#include "tests/campaigns/faults/run_import.h"

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <exception>
#include <stdexcept>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace splatlas {
namespace {

namespace fs = std::filesystem;

std::ptrdiff_t open_files() {
  return std::distance(fs::directory_iterator("/proc/self/fd"), fs::directory_iterator());
}

/// The import in the process that must survive. Writes a digit for the outcome and the message.
[[noreturn]] void import_and_exit(const ImportKind& kind, const fs::path& path, int answer) {
  std::string text;
  try {
    const std::ptrdiff_t files = open_files();
    const ImportEnd end = kind.import(path);
    text = fmt::format("{}{}", static_cast<int>(end.outcome), end.message);
    if (::waitpid(-1, nullptr, WNOHANG) != -1 || errno != ECHILD) text = "?leaves a child";
    if (open_files() != files) text = "?leaves an open file";
  } catch (const std::exception& exception) {
    text = fmt::format("?throws {}", exception.what());
  }
  const auto written = ::write(answer, text.data(), text.size());
  ::_exit(written == static_cast<ssize_t>(text.size()) ? 0 : 1);
}

/// Reads to the end, for at most `seconds` without a byte.
std::string read_all(int file, int seconds) {
  std::string text;
  std::array<char, 4096> piece{};
  pollfd readable{file, POLLIN, 0};
  while (::poll(&readable, 1, seconds * 1000) == 1) {
    const ssize_t count = ::read(file, piece.data(), piece.size());
    if (count <= 0) break;
    text.append(piece.data(), static_cast<std::size_t>(count));
  }
  return text;
}

/// What `text` and `status` of the process say.
void judge(const std::string& text, int status, ImportRun& run) {
  if (WIFSIGNALED(status)) {
    run.violation = fmt::format("the process was ended by signal {}", WTERMSIG(status));
  } else if (text.empty() || WEXITSTATUS(status) != 0) {
    run.violation = fmt::format("the process exited with status {}", WEXITSTATUS(status));
  } else if (text.front() == '?') {
    run.violation = "the process " + text.substr(1);
  } else {
    run.end = {static_cast<Outcome>(text.front() - '0'), text.substr(1)};
  }
}

}  // namespace

void adopt_orphans() {
  ::prctl(PR_SET_CHILD_SUBREAPER, 1);
}

ImportRun run_import(const ImportKind& kind, const fs::path& path) {
  constexpr int kHangs = 200;  // seconds
  const auto begun = std::chrono::steady_clock::now();
  std::array<int, 2> ends{};
  if (::pipe(ends.data()) != 0) throw std::runtime_error("no pipe can be made");
  const pid_t process = ::fork();
  if (process < 0) throw std::runtime_error("no process can be made");
  if (process == 0) import_and_exit(kind, path, ends[1]);
  ::close(ends[1]);
  const std::string text = read_all(ends[0], kHangs);
  ::close(ends[0]);
  if (text.empty()) ::kill(process, SIGKILL);
  ImportRun run;
  rusage usage{};
  int status = 0;
  while (::wait4(process, &status, 0, &usage) < 0 && errno == EINTR) {
  }
  judge(text, status, run);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  run.cpu_seconds = seconds(usage.ru_utime) + seconds(usage.ru_stime);
  run.wall_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  run.peak_bytes = static_cast<std::uint64_t>(usage.ru_maxrss) << 10;
  if (::waitpid(-1, nullptr, WNOHANG) != -1) run.violation = "a process of the reader is left";
  return run;
}

}  // namespace splatlas

#include "tests/support/run_program.h"

#include <cerrno>
#include <stdexcept>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/file_bytes.h"

namespace splatlas {

ProgramResult run_program(const std::vector<std::string>& words, const std::filesystem::path& folder,
                          const std::function<void(int)>& meanwhile, const std::function<void()>& before) {
  const TemporaryFolder temporary;
  const std::string out = temporary.file("out");
  const std::string err = temporary.file("err");
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);

  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("cannot fork");
  if (child == 0) {
    const int in_file = open("/dev/null", O_RDONLY);
    const int out_file = open(out.c_str(), O_WRONLY | O_CREAT, 0600);
    const int err_file = open(err.c_str(), O_WRONLY | O_CREAT, 0600);
    if (in_file < 0 || out_file < 0 || err_file < 0 || chdir(folder.c_str()) != 0) _exit(126);
    dup2(in_file, 0);
    dup2(out_file, 1);
    dup2(err_file, 2);
    if (before) before();
    execvp(arguments[0], arguments.data());
    _exit(127);
  }
  if (meanwhile) meanwhile(child);
  int status = 0;
  rusage usage{};
  pid_t ended = -1;
  do {
    ended = wait4(child, &status, 0, &usage);
  } while (ended < 0 && errno == EINTR);
  if (ended != child) throw std::runtime_error("cannot wait for the program");
  ProgramResult result;
  result.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  result.cpu_seconds = seconds(usage.ru_utime) + seconds(usage.ru_stime);
  result.peak_bytes = static_cast<std::uint64_t>(usage.ru_maxrss) << 10;
  result.out = read_bytes(out);
  result.err = read_bytes(err);
  return result;
}

}  // namespace splatlas

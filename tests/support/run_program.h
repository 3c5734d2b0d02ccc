// Runs a program as a user would, and keeps what it says.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace splatlas {

struct ProgramResult {
  int status = -1;  ///< exit status; 128 + signal when a signal ended it
  std::string out, err;
};

/// Runs `words[0]` with the other words as arguments, no shell in between, in `folder`. `meanwhile` is called
/// with the process's number while the program runs (or when it has ended already, but was not waited for);
/// `before` is called in the new process, right before it becomes the program.
[[nodiscard]] ProgramResult run_program(const std::vector<std::string>& words,
                                        const std::filesystem::path& folder = std::filesystem::current_path(),
                                        const std::function<void(int)>& meanwhile = {},
                                        const std::function<void()>& before = {});

/// An empty folder of its own under the system's temporary one, removed with everything in it at the end.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] std::string file(const std::string& name) const { return (path_ / name).string(); }
  /// Names of what is in it now, sorted.
  [[nodiscard]] std::vector<std::string> names() const;

 private:
  std::filesystem::path path_;
};

}  // namespace splatlas

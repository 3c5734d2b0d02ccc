// Isolation of readers of strangers' files: a forked child with limits of memory and time.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>

#include "format/result.h"
#include "format/result_macros.h"
#include "preprocess/import/isolation/archive.h"

namespace splatlas {

/// Limits of a child. A child that exceeds them ends, and so do its own children.
struct ChildLimits {
  double cpu_seconds = 15;                         ///< between two calls of report_child_progress()
  double wall_seconds = 120;                       ///< the same, for a child that sleeps or waits for a disk
  std::uint64_t bytes = std::uint64_t{512} << 20;  ///< beside what the parent holds
};

/// Limits in proportion to the bytes of a file, or of the files in a folder: a compressed file of a few MB
/// may hold a volume of a GB. At most half of the machine's memory.
[[nodiscard]] ChildLimits limits_for(const std::filesystem::path& path);

/// Restarts the time limits of this child, and tells the parent which file it reads: messages of a crash name
/// it. Does nothing outside a child.
void report_child_progress(const std::filesystem::path& file);

/// Memory file with the answer of a child that has ended.
class ChildAnswer {
 public:
  explicit ChildAnswer(int file) : file_(file) {}
  ~ChildAnswer();
  ChildAnswer(ChildAnswer&& other) noexcept : file_(std::exchange(other.file_, -1)) {}
  ChildAnswer& operator=(ChildAnswer&&) = delete;

  [[nodiscard]] int file() const { return file_; }
  [[nodiscard]] std::uint64_t bytes() const;

 private:
  int file_;
};

/// Runs `answer` in a child. It gets the descriptor of the answer's file, and returns false if it cannot
/// write it. kFailed if the child crashes, exits, or exceeds its limits; the message calls the input `path`.
[[nodiscard]] Result<ChildAnswer> run_child(const std::filesystem::path& path, const ChildLimits& limits,
                                            const std::function<bool(int file)>& answer);

inline void transfer(auto& archive, Error& error) {
  archive(error.code, error.message);
}

/// Runs `read`, which returns a Result<T>, in a child, and returns its result. T needs a function
/// transfer(archive, T&). What libraries print is dropped: it may hold names of patients. Cost: about 1 ms,
/// and two copies of the result. Call it while this process has one thread: locks that other threads hold
/// stay locked in a child.
template <typename T, typename Read>
[[nodiscard]] Result<T> run_isolated(const std::filesystem::path& path, const Read& read) {
  SPLATLAS_ASSIGN_OR_RETURN(const ChildAnswer answer, run_child(path, limits_for(path), [&](int file) {
                              Result<T> result = read();
                              ArchiveWriter archive(file);
                              bool has_value = result.has_value();
                              archive(has_value);
                              if (has_value) {
                                archive(*result);
                              } else {
                                archive(result.error());
                              }
                              return archive.finish();
                            }));
  ArchiveReader archive(answer.file(), answer.bytes());
  bool has_value = false;
  archive(has_value);
  T value{};
  Error error;
  if (has_value) {
    archive(value);
  } else {
    archive(error);
  }
  if (!archive.finish())
    return fail(ErrorCode::kFailed, "{}: its reader gave no whole answer", path.string());
  if (!has_value) return tl::unexpected(std::move(error));
  return value;
}

}  // namespace splatlas

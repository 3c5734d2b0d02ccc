// Isolation of readers of untrusted files: a forked child with limits of memory and time.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "format/result.h"
#include "format/result_macros.h"

namespace splatlas {

template <typename T>
concept ArchivedAsBytes = std::is_trivially_copyable_v<T>;

/// Moves values from memory to a file, or back. Structs with strings and lists are moved by their function
/// `transfer(archive, value)`, which passes all members to the archive. Checks every length that it reads
/// against the bytes that are left: the writer may have been damaged by its input.
class Archive {
 public:
  enum class Direction { kWrite, kRead };

  /// Reads `file` from its start.
  Archive(std::FILE* file, Direction direction) : file_(file), reads_(direction == Direction::kRead) {
    if (!reads_) return;
    std::fseek(file_, 0, SEEK_END);
    left_ = static_cast<std::uint64_t>(std::max(std::ftell(file_), 0L));
    std::rewind(file_);
  }

  template <typename... T>
  void operator()(T&... values) {
    (move(values), ...);
  }
  /// Writes what is buffered. False unless everything was written, or read to the end.
  [[nodiscard]] bool finish() { return good_ && left_ == 0 && (reads_ || std::fflush(file_) == 0); }

 private:
  template <ArchivedAsBytes T>
  void move(T& value) {
    move_bytes(&value, sizeof(value));
  }
  void move(bool& value) {
    std::uint8_t byte = value ? 1 : 0;
    move(byte);
    value = byte != 0;
  }
  void move(std::string& text) {
    text.resize(move_length(text.size()));
    move_bytes(text.data(), text.size());
  }
  void move(std::vector<std::byte>& bytes) {
    bytes.resize(move_length(bytes.size()));
    move_bytes(bytes.data(), bytes.size());
  }
  template <typename T>
  void move(std::vector<T>& values) {
    const std::size_t count = move_length(values.size());
    for (std::size_t n = 0; n < count && good_; ++n) move(reads_ ? values.emplace_back() : values[n]);
  }
  template <typename T>
  void move(std::optional<T>& value) {
    bool has_value = value.has_value();
    move(has_value);
    if (has_value) move(reads_ ? value.emplace() : *value);
  }
  template <typename T>
  void move(T& value) {
    transfer(*this, value);
  }

  /// A count of items of a byte or more; 0 if so many cannot follow.
  std::size_t move_length(std::uint64_t count) {
    move(count);
    good_ = good_ && (!reads_ || count <= left_);
    return good_ ? static_cast<std::size_t>(count) : 0;
  }
  void move_bytes(void* bytes, std::size_t count) {
    good_ = good_ && (!reads_ || count <= left_) &&
            (reads_ ? std::fread(bytes, 1, count, file_) : std::fwrite(bytes, 1, count, file_)) == count;
    if (good_ && reads_) left_ -= count;
  }

  std::FILE* file_;
  bool reads_, good_ = true;
  std::uint64_t left_ = 0;
};

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

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
/// Memory file with the answer of a child that has ended.
using ChildAnswer = std::unique_ptr<std::FILE, CloseFile>;

/// Runs `answer` in a child. It gets the answer's file, and returns false if it cannot write it. kFailed if
/// the child crashes, exits, or exceeds its limits; the message calls the input `path`.
[[nodiscard]] Result<ChildAnswer> run_child(const std::filesystem::path& path, const ChildLimits& limits,
                                            const std::function<bool(std::FILE* file)>& answer);

inline void transfer(auto& archive, Error& error) {
  archive(error.code, error.message);
}

/// Writes a result, or reads it. False if it is not whole.
template <typename T>
[[nodiscard]] bool transfer_result(Archive archive, Result<T>& result) {
  bool has_value = result.has_value();
  archive(has_value);
  if (!has_value && result) result = tl::unexpected(Error());
  if (has_value) {
    archive(*result);
  } else {
    archive(result.error());
  }
  return archive.finish();
}

/// Runs `read`, which returns a Result<T>, in a child, and returns its result. T is trivially copyable or has
/// a function transfer(archive, T&). What libraries print is dropped: it may hold names of patients. Cost:
/// about 1 ms, and two copies of the result. Call it while this process has one thread: locks that other
/// threads hold stay locked in a child.
template <typename T, typename Read>
[[nodiscard]] Result<T> run_isolated(const std::filesystem::path& path, const Read& read) {
  const auto answer_with = [&](std::FILE* file) {
    Result<T> result = read();
    return transfer_result({file, Archive::Direction::kWrite}, result);
  };
  SPLATLAS_ASSIGN_OR_RETURN(const ChildAnswer answer, run_child(path, limits_for(path), answer_with));
  Result<T> result;
  if (!transfer_result({answer.get(), Archive::Direction::kRead}, result))
    return fail(ErrorCode::kFailed, "{}: its reader gave no whole answer", path.string());
  return result;
}

}  // namespace splatlas

// Isolation of readers of untrusted files: a forked child with limits of memory and time.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <unistd.h>

#include "format/result.h"
#include "format/result_macros.h"

namespace splatlas {

template <typename T>
concept ArchivedAsBytes = std::is_arithmetic_v<T> || std::is_enum_v<T>;

/// Writes values to a file. Structs are written by their function `transfer(archive, value)`, which passes
/// all members to the archive: one function serves both directions.
class ArchiveWriter {
 public:
  explicit ArchiveWriter(int file) : file_(file) {}

  template <typename... T>
  void operator()(T&... values) {
    (put(values), ...);
  }
  /// Writes what is buffered. False if anything could not be written.
  [[nodiscard]] bool finish() {
    flush();
    return good_;
  }

 private:
  template <ArchivedAsBytes T>
  void put(const T& value) {
    append(std::as_bytes(std::span(&value, 1)));
  }
  void put(std::string& text) { put_bytes(std::as_bytes(std::span(text))); }
  void put(std::vector<std::byte>& bytes) { put_bytes(bytes); }
  template <typename T>
  void put(std::vector<T>& values) {
    put(static_cast<std::uint64_t>(values.size()));
    for (T& value : values) put(value);
  }
  template <typename T, std::size_t N>
  void put(std::array<T, N>& values) {
    for (T& value : values) put(value);
  }
  template <typename T>
  void put(std::optional<T>& value) {
    put(value.has_value());
    if (value) put(*value);
  }
  template <typename T>
  requires(std::is_class_v<T>) void put(T& value) { transfer(*this, value); }

  void put_bytes(std::span<const std::byte> bytes) {
    put(static_cast<std::uint64_t>(bytes.size()));
    append(bytes);
  }
  void append(std::span<const std::byte> bytes) {
    constexpr std::size_t kBuffered = 1 << 16;
    if (bytes.size() < kBuffered) {
      buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
      if (buffer_.size() >= kBuffered) flush();
    } else {
      flush();
      write_all(bytes);
    }
  }
  void flush() {
    write_all(buffer_);
    buffer_.clear();
  }
  void write_all(std::span<const std::byte> bytes) {
    while (good_ && !bytes.empty()) {
      const ssize_t written = ::write(file_, bytes.data(), std::min(bytes.size(), std::size_t{1} << 30));
      good_ = written > 0;
      if (good_) bytes = bytes.subspan(static_cast<std::size_t>(written));
    }
  }

  int file_;
  std::vector<std::byte> buffer_;
  bool good_ = true;
};

/// Reads what ArchiveWriter wrote. Checks every length against the bytes that are left: the writer may have
/// been damaged by its input.
class ArchiveReader {
 public:
  /// `bytes`: length of the file, which is read from its start.
  ArchiveReader(int file, std::uint64_t bytes) : file_(file), left_(bytes) {}

  template <typename... T>
  void operator()(T&... values) {
    (get(values), ...);
  }
  /// True if everything was read, to the end.
  [[nodiscard]] bool finish() const { return good_ && left_ == 0; }

 private:
  template <ArchivedAsBytes T>
  void get(T& value) {
    read_all(std::as_writable_bytes(std::span(&value, 1)));
  }
  void get(bool& value) {
    std::uint8_t byte = 0;
    get(byte);
    value = byte != 0;
  }
  void get(std::string& text) {
    text.resize(length(1));
    read_all(std::as_writable_bytes(std::span(text)));
  }
  void get(std::vector<std::byte>& bytes) {
    bytes.resize(length(1));
    read_all(bytes);
  }
  template <typename T>
  void get(std::vector<T>& values) {
    const std::size_t count = length(1);
    for (std::size_t n = 0; n < count && good_; ++n) get(values.emplace_back());
  }
  template <typename T, std::size_t N>
  void get(std::array<T, N>& values) {
    for (T& value : values) get(value);
  }
  template <typename T>
  void get(std::optional<T>& value) {
    bool has_value = false;
    get(has_value);
    if (has_value) get(value.emplace());
  }
  template <typename T>
  requires(std::is_class_v<T>) void get(T& value) { transfer(*this, value); }

  /// A count of items of at least `bytes_each`; 0 if so many cannot follow.
  std::size_t length(std::uint64_t bytes_each) {
    std::uint64_t count = 0;
    get(count);
    good_ = good_ && count <= left_ / bytes_each;
    return good_ ? static_cast<std::size_t>(count) : 0;
  }
  void read_all(std::span<std::byte> bytes) {
    good_ = good_ && bytes.size() <= left_;
    while (good_ && !bytes.empty()) {
      const ssize_t read =
          ::pread(file_, bytes.data(), std::min(bytes.size(), std::size_t{1} << 30), offset_);
      good_ = read > 0;
      if (!good_) break;
      bytes = bytes.subspan(static_cast<std::size_t>(read));
      offset_ += read;
      left_ -= static_cast<std::uint64_t>(read);
    }
  }

  int file_;
  off_t offset_ = 0;
  std::uint64_t left_;
  bool good_ = true;
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

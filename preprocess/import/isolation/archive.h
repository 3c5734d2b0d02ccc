// Serialisation of results between a child and its parent.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include <unistd.h>

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

}  // namespace splatlas

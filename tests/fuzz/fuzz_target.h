// Fuzz targets of the program, by name, and their inputs.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>

#include "tests/fuzz/cost_limit.h"

namespace splatlas {

/// Reads numbers, strings and the rest of an input from its front; zeros past the end.
class FuzzInput {
 public:
  FuzzInput(const std::uint8_t* data, std::size_t size)
      : bytes_(reinterpret_cast<const std::byte*>(data), size) {}

  [[nodiscard]] bool empty() const { return bytes_.empty(); }

  /// Little-endian.
  template <typename T>
  [[nodiscard]] T number() {
    static_assert(std::is_arithmetic_v<T> && !std::is_same_v<T, bool>);
    T value{};
    const auto from = take(sizeof(T));
    if (!from.empty()) std::memcpy(&value, from.data(), from.size());
    return value;
  }
  /// Below `n`, which is not 0: from one byte where possible, else from two.
  [[nodiscard]] std::size_t below(std::size_t n) {
    return (n <= 256 ? number<std::uint8_t>() : number<std::uint16_t>()) % n;
  }
  [[nodiscard]] bool flag() { return below(2) != 0; }

  /// Up to `count` bytes.
  [[nodiscard]] std::span<const std::byte> take(std::size_t count) {
    const auto taken = bytes_.first(std::min(count, bytes_.size()));
    bytes_ = bytes_.subspan(taken.size());
    return taken;
  }
  [[nodiscard]] std::string_view text(std::size_t count) { return as_text(take(count)); }

  [[nodiscard]] std::span<const std::byte> rest() { return take(bytes_.size()); }
  [[nodiscard]] std::string_view rest_as_text() { return as_text(rest()); }

 private:
  static std::string_view as_text(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }

  std::span<const std::byte> bytes_;
};

/// The seeds take at most 4 ms and 1.2 MiB. A quarter of a second allows for page faults and for tables that
/// are built at first use; 50 us per byte are 0.4 s for the longest input of scripts/fuzz.sh (8 KiB). Deflate
/// expands a byte to at most 1032, and a reader holds the bytes up to four times while it converts them:
/// 4 KiB per byte.
inline constexpr InputLimit kUsualLimit{.floor = {0.25, 8 << 20}, .per_byte = {50e-6, 4096}};

/// A target, in the list of the program from its construction on.
class FuzzTarget {
 public:
  /// `fuzz` aborts on a finding. `name` is that of its source NAME_fuzzer.cpp.
  FuzzTarget(std::string_view name, void (*fuzz)(FuzzInput), const InputLimit& limit = kUsualLimit);

  [[nodiscard]] std::string_view name() const { return name_; }
  /// An input within its limit.
  void run(const std::uint8_t* data, std::size_t size) const;

 private:
  std::string_view name_;
  void (*fuzz_)(FuzzInput);
  InputLimit limit_;
};

/// Null: there is none of this name.
[[nodiscard]] const FuzzTarget* find_target(std::string_view name);

}  // namespace splatlas

// Reader of a fuzz input, from its front.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>

namespace splatlas {

/// Numbers, strings and the rest; zeros past the end.
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

}  // namespace splatlas

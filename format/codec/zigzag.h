// Zigzag encoding of signed integers.
#pragma once

#include <concepts>
#include <limits>
#include <type_traits>

namespace splatlas {

/// Maps 0, -1, 1, -2, ... to 0, 1, 2, 3, ...
template <std::signed_integral T>
[[nodiscard]] constexpr std::make_unsigned_t<T> zigzag(T value) {
  using Unsigned = std::make_unsigned_t<T>;
  return (static_cast<Unsigned>(value) << 1) ^ static_cast<Unsigned>(value >> std::numeric_limits<T>::digits);
}

template <std::unsigned_integral T>
[[nodiscard]] constexpr std::make_signed_t<T> unzigzag(T code) {
  using Signed = std::make_signed_t<T>;
  return static_cast<Signed>(code >> 1) ^ -static_cast<Signed>(code & 1);
}

}  // namespace splatlas

// Mutations of numbers towards corner cases.
#pragma once

#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

namespace splatlas {

using Random = std::minstd_rand;

/// Below `n`, which is not 0.
[[nodiscard]] inline std::size_t below(std::size_t n, Random& random) {
  return random() % n;
}

/// A neighbour of the old value, a power of two, an extreme, or any value.
template <std::integral T>
void mutate_number(T& number, Random& random) {
  using Limits = std::numeric_limits<T>;
  const auto wide = static_cast<std::uint64_t>(number);
  switch (below(8, random)) {
    case 0: number = 0; break;
    case 1: number = static_cast<T>(wide + 1); break;
    case 2: number = static_cast<T>(wide - 1); break;
    case 3: number = static_cast<T>(wide ^ std::uint64_t{1} << below(8 * sizeof(T), random)); break;
    case 4: number = static_cast<T>(std::uint64_t{1} << below(8 * sizeof(T), random)); break;
    case 5: number = below(2, random) == 0 ? Limits::max() : Limits::min(); break;
    case 6: number = static_cast<T>(below(16, random)); break;
    default: number = static_cast<T>(std::uint64_t{random()} << 32 ^ random()); break;
  }
}

template <std::floating_point T>
void mutate_number(T& number, Random& random) {
  using Limits = std::numeric_limits<T>;
  switch (below(8, random)) {
    case 0: number = 0; break;
    case 1: number = -number; break;
    case 2: number = std::nextafter(number, Limits::infinity()); break;
    case 3: number *= static_cast<T>(std::ldexp(1.0, static_cast<int>(below(128, random)) - 64)); break;
    case 4: number = below(2, random) == 0 ? Limits::infinity() : Limits::quiet_NaN(); break;
    case 5: number = below(2, random) == 0 ? Limits::max() : Limits::denorm_min(); break;
    case 6: number = static_cast<T>(static_cast<double>(below(2000, random)) / 10 - 100); break;
    default: number += static_cast<T>(static_cast<double>(below(201, random)) / 100 - 1); break;
  }
}

/// Mutates one of several numbers.
template <typename... T>
void mutate_any(Random& random, T&... numbers) {
  std::size_t rest = below(sizeof...(T), random);
  ((rest-- == 0 ? mutate_number(numbers, random) : void()), ...);
}

/// A random entry of a table that is not empty.
template <typename T>
[[nodiscard]] T& any_of(std::vector<T>& entries, Random& random) {
  return entries[below(entries.size(), random)];
}

}  // namespace splatlas

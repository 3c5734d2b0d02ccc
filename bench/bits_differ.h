// Bitwise comparison of pictures.
#pragma once

#include <cstdint>
#include <span>

namespace splatlas {

/// Number of values that differ in their bits; with unequal lengths, the length of the longer.
[[nodiscard]] std::uint64_t bits_differ(std::span<const float> a, std::span<const float> b);

}  // namespace splatlas

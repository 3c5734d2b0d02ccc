// Pictures compared bit for bit.
#pragma once

#include <cstdint>
#include <span>

namespace splatlas {

/// Values that are not the same bits; all of the longer one where lengths differ.
[[nodiscard]] std::uint64_t bits_differ(std::span<const float> a, std::span<const float> b);

}  // namespace splatlas

// The checksum of headers, directories and chunks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace splatlas {

/// XXH3, 64 bits, seed 0. Tells damage, not forgery.
[[nodiscard]] std::uint64_t checksum_of(std::span<const std::byte> bytes);

}  // namespace splatlas

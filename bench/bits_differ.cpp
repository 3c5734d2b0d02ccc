#include "bench/bits_differ.h"

#include <algorithm>
#include <bit>
#include <cstddef>

namespace splatlas {

std::uint64_t bits_differ(std::span<const float> a, std::span<const float> b) {
  if (a.size() != b.size()) return std::max(a.size(), b.size());
  std::uint64_t differ = 0;
  for (std::size_t n = 0; n < a.size(); ++n) {
    differ += std::bit_cast<std::uint32_t>(a[n]) != std::bit_cast<std::uint32_t>(b[n]) ? 1 : 0;
  }
  return differ;
}

}  // namespace splatlas

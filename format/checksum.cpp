#include "format/checksum.h"

// Compiled in, so that whoever links the library does not have to link xxHash.
#define XXH_INLINE_ALL
#include <xxhash.h>

namespace splatlas {

std::uint64_t checksum_of(std::span<const std::byte> bytes) {
  return XXH3_64bits(bytes.data(), bytes.size());
}

}  // namespace splatlas

// How much memory there is.
#pragma once

#include <cstdint>

namespace splatlas {

/// Bytes that one task may take: three quarters of the machine's memory, or of what the process may have
/// (RLIMIT_AS, RLIMIT_DATA) where that is less. What asks for more is refused before it is allocated: the
/// system would grant it and end the process later.
[[nodiscard]] std::uint64_t default_memory_limit();

}  // namespace splatlas

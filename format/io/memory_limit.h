// Default memory limit of one task.
#pragma once

#include <cstdint>

namespace splatlas {

/// Bytes of physical memory, or of RLIMIT_AS or RLIMIT_DATA if lower.
[[nodiscard]] std::uint64_t machine_memory();

/// Bytes that one task may allocate: half of machine_memory(). Larger requests are refused up
/// front, because the system overcommits and ends the process later.
[[nodiscard]] std::uint64_t default_memory_limit();

/// Ends messages about allocations that failed.
inline constexpr const char* kOutOfMemoryRemedy = "free memory, or raise the program's limit";

}  // namespace splatlas

#include "format/io/memory_limit.h"

#include <algorithm>

#include <sys/resource.h>
#include <unistd.h>

namespace splatlas {

std::uint64_t machine_memory() {
  const long pages = sysconf(_SC_PHYS_PAGES);
  const long page_bytes = sysconf(_SC_PAGESIZE);
  const bool known = pages > 0 && page_bytes > 0;
  std::uint64_t memory = known ? static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(page_bytes)
                               : std::uint64_t{4} << 30;
  for (const auto resource : {RLIMIT_AS, RLIMIT_DATA}) {
    rlimit limit{};
    if (getrlimit(resource, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY) {
      memory = std::min<std::uint64_t>(memory, limit.rlim_cur);
    }
  }
  return memory;
}

std::uint64_t default_memory_limit() {
  return machine_memory() / 2;
}

}  // namespace splatlas

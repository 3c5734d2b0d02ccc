#include "tests/fuzz/cost_limit.h"

#include <algorithm>
#include <atomic>
#include <ctime>
#include <mutex>
#include <utility>

#include <fmt/format.h>

#include "tests/fuzz/require.h"

// Provided by the allocator of sanitizers; null without one.
extern "C" {
__attribute__((weak)) int __sanitizer_install_malloc_and_free_hooks(void (*on_malloc)(const volatile void*,
                                                                                      std::size_t),
                                                                    void (*on_free)(const volatile void*));
__attribute__((weak)) std::size_t __sanitizer_get_allocated_size(const volatile void* address);
}

namespace splatlas {
namespace {

std::atomic<std::int64_t> held{0}, max_held{0};

void on_malloc(const volatile void*, std::size_t bytes) {
  const std::int64_t now = held += static_cast<std::int64_t>(bytes);
  if (now > max_held) max_held = now;  // a race costs precision only
}

void on_free(const volatile void* address) {
  if (address != nullptr) held -= static_cast<std::int64_t>(__sanitizer_get_allocated_size(address));
}

void install_hooks() {
  static std::once_flag once;
  std::call_once(once, [] {
    if (__sanitizer_install_malloc_and_free_hooks != nullptr)
      __sanitizer_install_malloc_and_free_hooks(on_malloc, on_free);
  });
}

double processor_seconds() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace

CostLimit::CostLimit(const Cost& limit, std::string what)
    : limit_(limit), what_(std::move(what)), begun_seconds_(processor_seconds()) {
  install_hooks();
  begun_bytes_ = held;
  max_bytes_outside_ = max_held.exchange(begun_bytes_);
}

CostLimit::~CostLimit() {
  const double seconds = processor_seconds() - begun_seconds_;
  const std::int64_t max_bytes = max_held;
  max_held = std::max(max_bytes, max_bytes_outside_);
  require(seconds <= limit_.seconds,
          fmt::format("{} took {:.2f} s, more than {:.2f} s", what_, seconds, limit_.seconds));
  const auto bytes = static_cast<double>(max_bytes - begun_bytes_);
  require(bytes <= limit_.bytes, fmt::format("{} held {:.1f} MiB at once, more than {:.1f} MiB", what_,
                                             bytes / 0x1p20, limit_.bytes / 0x1p20));
}

}  // namespace splatlas

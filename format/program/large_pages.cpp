// Large pages for the large arrays of a program: page faults of small ones can take more than half of the
// time to open a large atlas. Replaces the allocation functions of the program that links it.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <new>

#include <sys/mman.h>

namespace {

constexpr std::uintptr_t kLargePage = std::uintptr_t{2} << 20;

/// A hint: systems without large pages refuse it.
void expect_dense(void* memory, std::size_t bytes) {
  const auto first = reinterpret_cast<std::uintptr_t>(memory);
  const std::uintptr_t before = (kLargePage - first % kLargePage) % kLargePage;
  const std::uintptr_t pages = bytes > before ? (bytes - before) / kLargePage : 0;
  if (pages > 0)
    static_cast<void>(madvise(static_cast<std::byte*>(memory) + before, pages * kLargePage, MADV_HUGEPAGE));
}

}  // namespace

void* operator new(std::size_t bytes) {
  void* const memory = std::malloc(bytes > 0 ? bytes : 1);
  if (memory == nullptr) throw std::bad_alloc();
  if (bytes >= 2 * kLargePage) expect_dense(memory, bytes);
  return memory;
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t /*bytes*/) noexcept {
  std::free(memory);
}

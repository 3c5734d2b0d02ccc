#include "tests/campaigns/faults/failing_allocator.h"

#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <limits>
#include <new>

#include <malloc.h>

namespace splatlas {
namespace {

constexpr std::uint64_t kNever = std::numeric_limits<std::uint64_t>::max();

// Constant initialisation: allocations precede all constructors.
constinit std::atomic<std::uint64_t> made{0}, first_failure{kNever}, last_failure{kNever};
constinit std::atomic<std::int64_t> alive{0};

thread_local bool registers = false;  // a destructor

bool fails() {
  if (registers) return false;
  const std::uint64_t number = made.fetch_add(1, std::memory_order_relaxed);
  return number >= first_failure.load(std::memory_order_relaxed) &&
         number <= last_failure.load(std::memory_order_relaxed);
}

}  // namespace

void FailingAllocator::arm(std::uint64_t number, bool lasting) {
  first_failure = kNever;
  made = 0;
  last_failure = lasting ? kNever : number;
  first_failure = number;
}

void FailingAllocator::disarm() {
  first_failure = kNever;
}

std::uint64_t FailingAllocator::count() {
  return made;
}

std::int64_t FailingAllocator::live() {
  return alive;
}

}  // namespace splatlas

#ifdef SPLATLAS_SANITIZED

namespace {

void* allocate(std::size_t size, std::size_t alignment) noexcept {
  if (splatlas::fails()) return nullptr;
  return std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
}

void* allocate_or_throw(std::size_t size, std::size_t alignment = __STDCPP_DEFAULT_NEW_ALIGNMENT__) {
  void* const memory = allocate(size, alignment);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace

// All forms are replaced: these could not free blocks of a sanitizer.
void* operator new(std::size_t size) {
  return allocate_or_throw(size);
}
void* operator new[](std::size_t size) {
  return allocate_or_throw(size);
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  return allocate_or_throw(size, static_cast<std::size_t>(alignment));
}
void* operator new[](std::size_t size, std::align_val_t alignment) {
  return allocate_or_throw(size, static_cast<std::size_t>(alignment));
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  return allocate(size, __STDCPP_DEFAULT_NEW_ALIGNMENT__);
}
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept {
  return allocate(size, __STDCPP_DEFAULT_NEW_ALIGNMENT__);
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete[](void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
void operator delete[](void* memory, std::size_t) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
  std::free(memory);
}
void operator delete[](void* memory, std::align_val_t) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  std::free(memory);
}
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept {
  std::free(memory);
}
void operator delete(void* memory, const std::nothrow_t&) noexcept {
  std::free(memory);
}
void operator delete[](void* memory, const std::nothrow_t&) noexcept {
  std::free(memory);
}

#else

// The C library's allocator, under the names that it reserves for replacements.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void __libc_free(void* memory);

/// Registers the destructor of a thread_local. The C library ends the process without memory for it.
int __cxa_thread_atexit_impl(void (*destructor)(void*), void* object, void* module) noexcept;
int __cxa_thread_atexit(void (*destructor)(void*), void* object, void* module) noexcept {
  splatlas::registers = true;
  const int status = __cxa_thread_atexit_impl(destructor, object, module);
  splatlas::registers = false;
  return status;
}

void* malloc(std::size_t size) noexcept {
  void* const memory = splatlas::fails() ? nullptr : __libc_malloc(size);
  memory == nullptr ? errno = ENOMEM : ++splatlas::alive;
  return memory;
}

void* calloc(std::size_t count, std::size_t size) noexcept {
  void* const memory = splatlas::fails() ? nullptr : __libc_calloc(count, size);
  memory == nullptr ? errno = ENOMEM : ++splatlas::alive;
  return memory;
}

void* realloc(void* old, std::size_t size) noexcept {
  if (old == nullptr) return malloc(size);
  void* const memory = splatlas::fails() && size > 0 ? nullptr : __libc_realloc(old, size);
  if (size == 0) {
    --splatlas::alive;
  } else if (memory == nullptr) {
    errno = ENOMEM;
  }
  return memory;
}

void* memalign(std::size_t alignment, std::size_t size) noexcept {
  void* const memory = splatlas::fails() ? nullptr : __libc_memalign(alignment, size);
  memory == nullptr ? errno = ENOMEM : ++splatlas::alive;
  return memory;
}

void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  return memalign(alignment, size);
}

int posix_memalign(void** to, std::size_t alignment, std::size_t size) noexcept {
  void* const memory = memalign(alignment, size);
  if (memory == nullptr) return ENOMEM;
  *to = memory;
  return 0;
}

void free(void* memory) noexcept {
  if (memory != nullptr) --splatlas::alive;
  __libc_free(memory);
}
}

#endif

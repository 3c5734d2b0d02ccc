// Replaces files, environment, pages and memory limit of a system, in sources of the format and functions of
// the C library. The module thus imports only a clock and an exit.
#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "format/io/input_file.h"
#include "format/io/memory_limit.h"
#include "format/result_macros.h"
#include "player/render/decode/sparse_bytes.h"
#include "player/render/rays/march_kernels.h"
#include "player/render/sheets/splat/splat_kernels.h"

extern "C" {
char* getenv(const char* /*name*/) {
  return nullptr;
}
int __syscall_madvise(int /*address*/, int /*length*/, int /*advice*/) {
  return 0;
}
void emscripten_notify_memory_growth(std::uint32_t /*memory*/) {}
}

namespace splatlas {

Result<InputFile> InputFile::open(const std::filesystem::path& path, bool /*map*/) {
  return fail(ErrorCode::kFailed, "{}: a page opens no files", path.string());
}

InputFile::InputFile(InputFile&& other) noexcept
    : read_(std::move(other.read_)), size_(std::exchange(other.size_, 0)), name_(std::move(other.name_)) {}
InputFile::~InputFile() = default;

Result<void> InputFile::read(std::uint64_t offset, std::span<std::byte> to) const {
  if (offset > size_ || to.size() > size_ - offset)
    return invalid_atlas("truncated: bytes {} to {} of {}", offset, offset + to.size(), size_);
  return read_(offset, to);
}

std::uint64_t machine_memory() {
  return std::uint64_t{2} << 30;  // as the module is linked
}
std::uint64_t default_memory_limit() {
  return machine_memory() / 2;
}

// The heap takes whole ranges. What drop() gives back is free for others: dlmalloc shrinks in place.
constexpr std::size_t kLine = 64;

Result<SparseBytes> SparseBytes::reserve(std::uint64_t bytes) {
  const auto size = static_cast<std::size_t>(std::min(bytes, machine_memory()) / kLine + 1) * kLine;
  void* const data = std::aligned_alloc(kLine, size);
  if (data == nullptr) return fail(ErrorCode::kLimit, "cannot reserve {} bytes; select less", bytes);
  SparseBytes sparse;
  sparse.data_ = {static_cast<std::byte*>(std::memset(data, 0, size)), Unmap{data, size, size}};
  return sparse;
}
void SparseBytes::Unmap::operator()(std::byte* /*data*/) const {
  std::free(mapped);
}
void SparseBytes::expect_dense() {}
void SparseBytes::drop(std::size_t bytes) {
  const std::size_t kept = std::max(bytes, kLine);
  void* const data = std::realloc(data_.release(), kept);
  data_ = {static_cast<std::byte*>(data), Unmap{data, kept, kept}};
}

// The module has one instruction set.
SplatKernels scalar_kernels() {
  return best_kernels();
}
MarchKernels scalar_march() {
  return best_march();
}

}  // namespace splatlas

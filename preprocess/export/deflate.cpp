#include "preprocess/export/deflate.h"

#include <algorithm>
#include <memory>
#include <vector>

#include <zlib.h>

#include "format/result_macros.h"
#include "format/tasks/task_control.h"

namespace splatlas {
namespace {

using Deflater = std::unique_ptr<z_stream, void (*)(z_stream*)>;

Deflater make_deflater(int window_bits, int level) {
  constexpr int kMemoryLevel = 8;  // zlib's default
  Deflater stream(new z_stream{}, [](z_stream* of) {
    deflateEnd(of);
    delete of;
  });
  const int status =
      deflateInit2(stream.get(), level, Z_DEFLATED, window_bits, kMemoryLevel, Z_DEFAULT_STRATEGY);
  if (status != Z_OK) stream.reset();
  return stream;
}

const unsigned char* as_input(std::span<const std::byte> bytes) {
  return reinterpret_cast<const unsigned char*>(bytes.data());
}

/// Compresses `bytes` and calls `take` with the result, piece by piece, up to its first error; `flush`
/// applies to the end of the bytes.
template <typename Take>
Result<void> pump(z_stream& stream, std::span<const std::byte> bytes, int flush, std::span<std::byte> buffer,
                  const Take& take) {
  constexpr std::size_t kMaxInput = std::size_t{1} << 30;  // zlib's counts have 32 bits
  do {
    const std::span<const std::byte> input = bytes.first(std::min(bytes.size(), kMaxInput));
    bytes = bytes.subspan(input.size());
    stream.next_in = const_cast<unsigned char*>(as_input(input));  // zlib does not change it
    stream.avail_in = static_cast<unsigned>(input.size());
    do {
      check_task();
      stream.next_out = reinterpret_cast<unsigned char*>(buffer.data());
      stream.avail_out = static_cast<unsigned>(buffer.size());
      deflate(&stream,
              bytes.empty() ? flush : Z_NO_FLUSH);  // cannot fail: the state is valid and there is room
      const std::size_t made = buffer.size() - stream.avail_out;
      if (made > 0) SPLATLAS_RETURN_IF_ERROR(take(buffer.first(made)));
    } while (stream.avail_out == 0);
  } while (!bytes.empty());
  return {};
}

}  // namespace

Result<void> deflate_in_pieces(std::initializer_list<std::span<const std::byte>> parts,
                               DeflateWrapper wrapper, int level, const std::filesystem::path& path,
                               const std::function<Result<void>(std::span<const std::byte>)>& write) {
  constexpr int kWindowBits = 15, kGzip = 16;
  const int bits = wrapper == DeflateWrapper::kGzip ? kWindowBits + kGzip : kWindowBits;
  const Deflater stream = make_deflater(bits, level);
  if (!stream) return fail(ErrorCode::kLimit, "{}: cannot be written: out of memory", path.string());
  std::vector<std::byte> buffer(1 << 18);
  for (const std::span<const std::byte> part : parts) {
    if (!part.empty()) SPLATLAS_RETURN_IF_ERROR(pump(*stream, part, Z_NO_FLUSH, buffer, write));
  }
  return pump(*stream, {}, Z_FINISH, buffer, write);
}

}  // namespace splatlas

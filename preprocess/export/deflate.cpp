#include "preprocess/export/deflate.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <new>
#include <utility>

#include <zlib.h>

#include "format/result_macros.h"
#include "format/tasks/task_control.h"

namespace splatlas {
namespace {

using Deflater = std::unique_ptr<z_stream, void (*)(z_stream*)>;

Deflater make_deflater(int window_bits, int level, int strategy) {
  constexpr int kMemoryLevel = 8;  // zlib's default
  Deflater stream(new z_stream{}, [](z_stream* of) {
    deflateEnd(of);
    delete of;
  });
  const int status = deflateInit2(stream.get(), level, Z_DEFLATED, window_bits, kMemoryLevel, strategy);
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
  const Deflater stream = make_deflater(bits, level, Z_DEFAULT_STRATEGY);
  if (!stream) return fail(ErrorCode::kLimit, "{}: cannot be written: out of memory", path.string());
  std::vector<std::byte> buffer(1 << 18);
  for (const std::span<const std::byte> part : parts) {
    if (!part.empty()) SPLATLAS_RETURN_IF_ERROR(pump(*stream, part, Z_NO_FLUSH, buffer, write));
  }
  return pump(*stream, {}, Z_FINISH, buffer, write);
}

struct GzipRuns::Stream {
  static constexpr std::size_t kZeros = std::size_t{1} << 16;
  Deflater deflater{nullptr, nullptr};
  std::vector<std::byte> zeros;  ///< a compressed block of kZeros zeros
  uLong append_zeros = 0;        ///< zlib's operator of its checksum
};

GzipRuns::GzipRuns() : stream_(std::make_unique<Stream>()) {
  constexpr int kRawWindowBits = -15, kFastest = 1;
  stream_->deflater = make_deflater(kRawWindowBits, kFastest, Z_RLE);
  if (!stream_->deflater) throw std::bad_alloc();
  deflate_block(std::vector<std::byte>(Stream::kZeros), Z_FULL_FLUSH);
  stream_->zeros = std::exchange(packed_, {});
  stream_->append_zeros = crc32_combine_gen(Stream::kZeros);
  constexpr std::array<unsigned char, 10> kHeader{0x1f, 0x8b, Z_DEFLATED, 0, 0,
                                                  0,    0,    0,          4, 3};  // fastest, Unix
  std::ranges::copy(std::as_bytes(std::span(kHeader)), std::back_inserter(packed_));
}

GzipRuns::~GzipRuns() = default;

void GzipRuns::add(std::span<const std::byte> bytes) {
  if (bytes.empty()) return;  // zlib takes a null pointer for a new checksum
  checksum_ = crc32_z(checksum_, as_input(bytes), bytes.size());
  bytes_ += bytes.size();
  deflate_block(bytes, Z_FULL_FLUSH);
}

void GzipRuns::add_zeros(std::uint64_t count) {
  static constexpr std::array<std::byte, Stream::kZeros> kNone{};
  const auto checksum_of_zeros = crc32_z(0, as_input(kNone), kNone.size());
  for (; count >= kNone.size(); count -= kNone.size()) {
    packed_.insert(packed_.end(), stream_->zeros.begin(), stream_->zeros.end());
    checksum_ = crc32_combine_op(checksum_, checksum_of_zeros, stream_->append_zeros);
    bytes_ += kNone.size();
  }
  add(std::span(kNone).first(count));
}

std::vector<std::byte> GzipRuns::finish() {
  deflate_block({}, Z_FINISH);
  for (const std::uint64_t number : {std::uint64_t{checksum_}, bytes_}) {
    for (unsigned shift = 0; shift < 32; shift += 8)
      packed_.push_back(static_cast<std::byte>(number >> shift));
  }
  return std::move(packed_);
}

void GzipRuns::deflate_block(std::span<const std::byte> bytes, int flush) {
  std::array<std::byte, 1 << 14> buffer;
  const auto append = [&](std::span<const std::byte> piece) -> Result<void> {
    packed_.insert(packed_.end(), piece.begin(), piece.end());
    return {};
  };
  static_cast<void>(pump(*stream_->deflater, bytes, flush, buffer, append));  // append() does not fail
}

}  // namespace splatlas

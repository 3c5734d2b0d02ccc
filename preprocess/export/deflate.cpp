#include "preprocess/export/deflate.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <memory>
#include <new>
#include <utility>
#include <vector>

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

}  // namespace

Result<void> deflate_in_pieces(std::initializer_list<std::span<const std::byte>> parts,
                               DeflateWrapper wrapper, int level, const std::filesystem::path& path,
                               const std::function<Result<void>(std::span<const std::byte>)>& write) {
  constexpr std::size_t kMaxInput = std::size_t{1} << 30;  // zlib's counts have 32 bits
  constexpr int kWindowBits = 15, kGzip = 16;
  const int bits = wrapper == DeflateWrapper::kGzip ? kWindowBits + kGzip : kWindowBits;
  const Deflater stream = make_deflater(bits, level, Z_DEFAULT_STRATEGY);
  if (!stream) return fail(ErrorCode::kLimit, "{}: cannot be written: out of memory", path.string());
  std::vector<std::byte> packed(1 << 18);

  // Compress what `stream` has as input; `flush` is Z_FINISH at the end.
  const auto drain = [&](int flush) -> Result<void> {
    do {
      check_task();
      stream->next_out = reinterpret_cast<unsigned char*>(packed.data());
      stream->avail_out = static_cast<unsigned>(packed.size());
      deflate(stream.get(), flush);  // cannot fail: the state is valid and there is room
      const std::size_t made = packed.size() - stream->avail_out;
      if (made > 0) SPLATLAS_RETURN_IF_ERROR(write(std::span(packed).first(made)));
    } while (stream->avail_out == 0);
    return {};
  };
  for (std::span<const std::byte> part : parts) {
    while (!part.empty()) {
      const std::span<const std::byte> input = part.first(std::min(part.size(), kMaxInput));
      // zlib does not change its input.
      stream->next_in = const_cast<unsigned char*>(as_input(input));
      stream->avail_in = static_cast<unsigned>(input.size());
      SPLATLAS_RETURN_IF_ERROR(drain(Z_NO_FLUSH));
      part = part.subspan(input.size());
    }
  }
  return drain(Z_FINISH);
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
  constexpr std::size_t kMaxInput = std::size_t{1} << 30;  // zlib's counts have 32 bits
  while (!bytes.empty()) {
    const std::span<const std::byte> input = bytes.first(std::min(bytes.size(), kMaxInput));
    checksum_ = crc32_z(checksum_, as_input(input), input.size());
    bytes_ += input.size();
    deflate_block(input, Z_FULL_FLUSH);
    bytes = bytes.subspan(input.size());
  }
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
  z_stream& stream = *stream_->deflater;
  stream.next_in = const_cast<unsigned char*>(as_input(bytes));  // zlib does not change it
  stream.avail_in = static_cast<unsigned>(bytes.size());
  do {
    constexpr std::size_t kRoom = 1 << 14;
    const std::size_t before = packed_.size();
    packed_.resize(before + kRoom);
    stream.next_out = reinterpret_cast<unsigned char*>(&packed_[before]);
    stream.avail_out = kRoom;
    deflate(&stream, flush);  // cannot fail: the state is valid and there is room
    packed_.resize(before + kRoom - stream.avail_out);
  } while (stream.avail_out == 0);
}

}  // namespace splatlas

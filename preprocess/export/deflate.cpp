#include "preprocess/export/deflate.h"

#include <algorithm>
#include <memory>
#include <vector>

#include <zlib.h>

#include "format/system/result_macros.h"

namespace splatlas {
namespace {

struct DeflateEnd {
  void operator()(z_stream* stream) const {
    deflateEnd(stream);
    delete stream;
  }
};
using Deflater = std::unique_ptr<z_stream, DeflateEnd>;

Deflater make_deflater(DeflateWrapper wrapper, DeflateEffort effort) {
  constexpr int kWindowBits = 15, kGzip = 16, kMemoryLevel = 8;  // zlib's defaults
  const int bits = wrapper == DeflateWrapper::kGzip ? kWindowBits + kGzip : kWindowBits;
  Deflater stream(new z_stream{});
  const int status = deflateInit2(stream.get(), effort.level, Z_DEFLATED, bits, kMemoryLevel,
                                  effort.finds_runs_only ? Z_RLE : Z_DEFAULT_STRATEGY);
  return status == Z_OK ? std::move(stream) : nullptr;
}

}  // namespace

Result<void> deflate_in_pieces(std::initializer_list<std::span<const std::byte>> parts,
                               DeflateWrapper wrapper, DeflateEffort effort,
                               const std::filesystem::path& path,
                               const std::function<Result<void>(std::span<const std::byte>)>& write) {
  constexpr std::size_t kMaxInput = std::size_t{1} << 30;  // zlib's counts have 32 bits
  const Deflater stream = make_deflater(wrapper, effort);
  if (!stream) return fail(ErrorCode::kLimit, "{}: cannot be written: out of memory", path.string());
  std::vector<std::byte> packed(1 << 18);

  // Compress what `stream` has as input; `flush` is Z_FINISH at the end.
  const auto drain = [&](int flush) -> Result<void> {
    do {
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
      stream->next_in = const_cast<unsigned char*>(reinterpret_cast<const unsigned char*>(input.data()));
      stream->avail_in = static_cast<unsigned>(input.size());
      SPLATLAS_RETURN_IF_ERROR(drain(Z_NO_FLUSH));
      part = part.subspan(input.size());
    }
  }
  return drain(Z_FINISH);
}

}  // namespace splatlas

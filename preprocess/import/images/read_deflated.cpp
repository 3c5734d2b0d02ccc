#include "preprocess/import/images/read_deflated.h"

#include <algorithm>
#include <fstream>
#include <memory>
#include <span>

#include <zlib.h>

#include "format/system/memory_limit.h"
#include "format/system/result_macros.h"
#include "preprocess/import/images/check_image_file.h"
#include "preprocess/import/import_error.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

struct InflateEnd {
  void operator()(z_stream* stream) const {
    inflateEnd(stream);
    delete stream;
  }
};
using Inflater = std::unique_ptr<z_stream, InflateEnd>;

Inflater make_inflater() {
  Inflater stream(new z_stream{});
  constexpr int kZlibOrGzip = 15 + 32;
  return inflateInit2(stream.get(), kZlibOrGzip) == Z_OK ? std::move(stream) : nullptr;
}

}  // namespace

Result<void> read_deflated(const fs::path& path, std::uint64_t offset, std::uint64_t bytes,
                           std::vector<std::byte>& pixels) {
  std::ifstream file(path, std::ios::binary);
  file.seekg(static_cast<std::streamoff>(offset));
  const Inflater stream = make_inflater();
  if (!stream) return fail(ErrorCode::kLimit, "{}: out of memory; {}", path.string(), kOutOfMemoryRemedy);

  constexpr std::uint64_t kPiece = 16u << 20;  // touched memory follows the stream, not its header
  std::vector<char> packed(1 << 18);
  std::vector<std::byte> surplus(1 << 18);
  std::uint64_t found = 0;
  pixels.clear();
  pixels.reserve(bytes);
  for (int status = Z_OK; status != Z_STREAM_END && found < bytes + kMaxSurplus;) {
    if (stream->avail_in == 0) {
      file.read(packed.data(), static_cast<std::streamsize>(packed.size()));
      stream->next_in = reinterpret_cast<unsigned char*>(packed.data());
      stream->avail_in = static_cast<unsigned>(file.gcount());
      if (stream->avail_in == 0 && found < bytes) return truncated_file(path, bytes, found);
      if (stream->avail_in == 0) {
        return bad_file(path,
                        "is truncated: the end of its compressed pixels, with their checksum, is missing");
      }
    }
    if (found == pixels.size()) pixels.resize(std::min(bytes, found + kPiece));
    const std::span<std::byte> to = found < bytes ? std::span(pixels).subspan(found) : std::span(surplus);
    stream->next_out = reinterpret_cast<unsigned char*>(to.data());
    stream->avail_out = static_cast<unsigned>(to.size());
    status = inflate(stream.get(), Z_NO_FLUSH);
    if (status != Z_OK && status != Z_STREAM_END) {
      return bad_file(path, "its compressed pixels are damaged after {} bytes ({})", found,
                      stream->msg ? stream->msg : "zlib");
    }
    found += to.size() - stream->avail_out;
    // Gzip files may have several members (bgzip): continue with the next one.
    if (status == Z_STREAM_END && found < bytes && inflateReset(stream.get()) == Z_OK) status = Z_OK;
  }
  if (found < bytes) return truncated_file(path, bytes, found);
  return {};
}

void swap_bytes(VoxelBuffer& voxels) {
  const auto size = static_cast<std::ptrdiff_t>(bytes_of(voxels.type));
  for (auto at = voxels.bytes.begin(); at != voxels.bytes.end(); at += size) std::reverse(at, at + size);
}

}  // namespace splatlas

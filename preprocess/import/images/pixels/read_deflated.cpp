#include "preprocess/import/images/pixels/read_deflated.h"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <memory>
#include <span>

#include <bzlib.h>
#include <zlib.h>

#include "format/io/memory_limit.h"
#include "format/result_macros.h"
#include "preprocess/import/images/pixels/check_image_file.h"
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

Result<void> read_bzip2(const fs::path& path, std::uint64_t offset, std::uint64_t bytes,
                        std::vector<std::byte>& pixels) {
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
    void operator()(BZFILE* stream) const {
      int ignored = BZ_OK;
      BZ2_bzReadClose(&ignored, stream);
    }
  };
  const std::unique_ptr<std::FILE, Close> file(std::fopen(path.c_str(), "rbe"));
  if (!file || ::fseeko(file.get(), static_cast<off_t>(offset), SEEK_SET) != 0)
    return bad_file(path, "cannot be read");
  int status = BZ_OK;
  const std::unique_ptr<BZFILE, Close> stream(BZ2_bzReadOpen(&status, file.get(), 0, 0, nullptr, 0));
  constexpr std::uint64_t kPiece = 16u << 20;
  pixels.clear();
  while (status == BZ_OK && pixels.size() < bytes) {
    const std::size_t done = pixels.size();
    pixels.resize(std::min(bytes, done + kPiece));
    const int found =
        BZ2_bzRead(&status, stream.get(), &pixels[done], static_cast<int>(pixels.size() - done));
    pixels.resize(done + static_cast<std::size_t>(std::max(found, 0)));
  }
  if (pixels.size() == bytes && status == BZ_OK) {  // the checksum follows the last byte
    std::byte surplus{};
    BZ2_bzRead(&status, stream.get(), &surplus, 1);
  }
  if (status != BZ_OK && status != BZ_STREAM_END)
    return bad_file(path, "its compressed pixels are damaged after {} bytes (bzip2 error {})", pixels.size(),
                    status);
  if (pixels.size() < bytes) return truncated_file(path, bytes, pixels.size());
  return {};
}

void swap_bytes(std::vector<std::byte>& voxels, std::size_t bytes_each) {
  const auto size = static_cast<std::ptrdiff_t>(bytes_each);
  for (auto at = voxels.begin(); at != voxels.end(); at += size) std::reverse(at, at + size);
}

}  // namespace splatlas

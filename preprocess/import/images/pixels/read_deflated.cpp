#include "preprocess/import/images/pixels/read_deflated.h"

#include <algorithm>
#include <cstdio>
#include <fstream>

#include <bzlib.h>

#include "format/io/memory_limit.h"
#include "format/result_macros.h"
#include "format/text/ascii_text.h"
#include "preprocess/import/images/pixels/check_image_file.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

template <typename Narrow, typename Wide>
VoxelBuffer copied(std::span<const Wide> values, VoxelType type) {
  VoxelBuffer result{type, std::vector<std::byte>(values.size() * sizeof(Narrow))};
  std::ranges::transform(values, result.as<Narrow>(), [](Wide value) { return static_cast<Narrow>(value); });
  return result;
}

template <typename Wide>
Result<VoxelBuffer> narrowed(std::span<const std::byte> bytes, const std::filesystem::path& path) {
  const std::span values(reinterpret_cast<const Wide*>(bytes.data()), bytes.size() / sizeof(Wide));
  const auto [low, high] = std::ranges::minmax(values);
  if (std::in_range<std::int32_t>(low) && std::in_range<std::int32_t>(high))
    return copied<std::int32_t>(values, VoxelType::kInt32);
  if (std::in_range<std::uint32_t>(low) && std::in_range<std::uint32_t>(high))
    return copied<std::uint32_t>(values, VoxelType::kUInt32);
  const Wide beyond = std::in_range<std::int32_t>(low) && low < 0 ? high
                      : std::in_range<std::uint32_t>(low)         ? high
                                                                  : low;
  return bad_file(path, "holds 64-bit integers from {} to {}; {} does not fit 32 bits", low, high, beyond);
}

}  // namespace

Result<void> read_deflated(const fs::path& path, std::uint64_t offset, std::uint64_t bytes,
                           std::vector<std::byte>& pixels) {
  std::ifstream file(path, std::ios::binary);
  file.seekg(static_cast<std::streamoff>(offset));
  constexpr int kZlibOrGzip = 15 + 32;
  z_stream stream{};
  if (inflateInit2(&stream, kZlibOrGzip) != Z_OK)
    return fail(ErrorCode::kLimit, "{}: out of memory; {}", path.string(), kOutOfMemoryRemedy);
  const std::unique_ptr<z_stream, int (*)(z_stream*)> end(&stream, inflateEnd);
  constexpr std::uint64_t kPiece = 16u << 20;  // touched memory follows the stream, not its header
  std::vector<char> packed(1 << 18);
  std::vector<std::byte> surplus(1 << 18);
  std::uint64_t found = 0;
  pixels.clear();
  pixels.reserve(bytes);
  for (int status = Z_OK; status != Z_STREAM_END && found < bytes + kMaxSurplus;) {
    if (stream.avail_in == 0) {
      file.read(packed.data(), static_cast<std::streamsize>(packed.size()));
      stream.next_in = reinterpret_cast<unsigned char*>(packed.data());
      stream.avail_in = static_cast<unsigned>(file.gcount());
      if (stream.avail_in == 0 && found < bytes) return truncated_file(path, bytes, found);
      if (stream.avail_in == 0) {
        return bad_file(path,
                        "is truncated: the end of its compressed pixels, with their checksum, is missing");
      }
    }
    if (found == pixels.size()) pixels.resize(std::min(bytes, found + kPiece));
    const std::span<std::byte> to = found < bytes ? std::span(pixels).subspan(found) : std::span(surplus);
    stream.next_out = reinterpret_cast<unsigned char*>(to.data());
    stream.avail_out = static_cast<unsigned>(to.size());
    status = inflate(&stream, Z_NO_FLUSH);
    if (status != Z_OK && status != Z_STREAM_END) {
      return bad_file(path, "its compressed pixels are damaged after {} bytes ({})", found,
                      stream.msg ? stream.msg : "zlib");
    }
    found += to.size() - stream.avail_out;
    // Gzip files may have several members (bgzip): continue with the next one.
    if (status == Z_STREAM_END && found < bytes && inflateReset(&stream) == Z_OK) status = Z_OK;
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

Result<VoxelBuffer> voxels_of(std::vector<std::byte> bytes, const StoredType& type,
                              const std::filesystem::path& path) {
  if (type.wide == WideInteger::kNone) return VoxelBuffer{type.type, std::move(bytes)};
  return type.wide == WideInteger::kSigned ? narrowed<std::int64_t>(bytes, path)
                                           : narrowed<std::uint64_t>(bytes, path);
}

Result<GzipFile> GzipFile::open(const std::filesystem::path& path) {
  GzipFile file;
  file.path_ = path;
  file.stream_.reset(gzopen(path.c_str(), "rb"));
  if (!file.stream_) return bad_file(path, "cannot be opened for reading");
  const std::string name = to_lower(path.filename().string());
  const bool should_be = name.ends_with(".gz") || name.ends_with(".mgz");
  if (file.is_compressed() == should_be) return file;
  if (should_be && first_bytes(path, 1).empty()) return bad_file(path, "is empty");
  return bad_file(path, "is {}compressed, which its ending denies; rename it", should_be ? "not " : "");
}

Result<std::size_t> GzipFile::read_some(std::span<std::byte> bytes) {
  const int count = gzread(stream_.get(), bytes.data(), static_cast<unsigned>(bytes.size()));
  if (count >= 0) return static_cast<std::size_t>(count);
  int status = Z_OK;
  return bad_file(path_, "its compressed bytes are damaged after {} bytes ({})", gztell(stream_.get()),
                  gzerror(stream_.get(), &status));
}

Result<std::vector<std::byte>> GzipFile::read(std::uint64_t offset, std::uint64_t count) {
  constexpr std::size_t kPiece = std::size_t{16} << 20;  // touched memory follows the file, not its header
  std::vector<std::byte> bytes;
  bytes.reserve(count);
  const auto start = static_cast<z_off_t>(offset);
  if (gzseek(stream_.get(), start, SEEK_SET) != start) return truncated_file(path_, count, 0);
  while (bytes.size() < count) {
    const std::size_t done = bytes.size();
    bytes.resize(std::min<std::uint64_t>(count, done + kPiece));
    SPLATLAS_ASSIGN_OR_RETURN(const std::size_t found, read_some(std::span(bytes).subspan(done)));
    if (done + found < bytes.size()) return truncated_file(path_, count, done + found);
  }
  return bytes;
}

Result<void> GzipFile::check_end() {
  if (!is_compressed()) return {};
  std::vector<std::byte> surplus(1 << 18);
  for (std::uint64_t found = 0; found < kMaxSurplus; found += surplus.size()) {
    SPLATLAS_ASSIGN_OR_RETURN(const std::size_t read, read_some(surplus));
    if (read < surplus.size()) break;
  }
  int status = Z_OK;
  const char* const reason = gzerror(stream_.get(), &status);
  if (status == Z_OK) return {};
  return bad_file(path_, "is truncated or damaged at the end of its compressed pixels ({})", reason);
}

}  // namespace splatlas

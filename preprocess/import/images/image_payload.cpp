#include "preprocess/import/images/image_payload.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <memory>
#include <vector>

#include <fmt/format.h>
#include <zlib.h>

#include "format/grid.h"
#include "format/system/result_macros.h"
#include "preprocess/import/import_error.h"
#include "preprocess/import/tables/text_file.h"

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

Result<fs::path> resolve_beside(const fs::path& header, const std::string& name) {
  std::error_code error;
  const fs::path folder =
      fs::canonical(header.has_parent_path() ? header.parent_path() : fs::path("."), error);
  const fs::path target = error ? fs::path() : fs::weakly_canonical(folder / name, error);
  const auto [rest_of_folder, unused] =
      std::mismatch(folder.begin(), folder.end(), target.begin(), target.end());
  if (error || rest_of_folder != folder.end() || fs::path(name).is_absolute()) {
    return bad_file(header, "names a pixel file outside its own folder: '{}'", name);
  }
  SPLATLAS_RETURN_IF_ERROR(check_regular_file(target));
  return target;
}

Result<std::uint64_t> payload_bytes(const fs::path& path, std::span<const std::int64_t> sizes,
                                    std::uint64_t bytes_per_voxel) {
  std::int64_t voxels = 1;
  for (const std::int64_t size : sizes) {
    if (size < 1 || size > kMaxAxisSize || voxels > kMaxVoxels / size) {
      return bad_file(path, "has an impossible size of {} voxels: at most {} along an axis, and {} in all",
                      fmt::join(sizes, " x "), kMaxAxisSize, kMaxVoxels);
    }
    voxels *= size;
  }
  return static_cast<std::uint64_t>(voxels) * bytes_per_voxel;
}

tl::unexpected<Error> truncated_file(const fs::path& path, std::uint64_t expected, std::uint64_t found) {
  return bad_file(path, "is truncated: its header promises {} bytes of pixels, {} are there", expected,
                  found);
}

Result<void> check_raw_payload(const fs::path& path, std::uint64_t offset, std::uint64_t needed,
                               std::uint64_t expected) {
  std::error_code error;
  const std::uint64_t size = fs::file_size(path, error);
  if (error) return bad_file(path, "{}", error.message());
  const std::uint64_t found = size > offset ? size - offset : 0;
  if (found < needed) return truncated_file(path, expected, found);
  return {};
}

Result<void> check_deflated_payload(const fs::path& path, std::uint64_t offset, std::uint64_t expected) {
  SPLATLAS_RETURN_IF_ERROR(check_raw_payload(path, offset, expected / kMaxDeflateRatio, expected));
  std::ifstream file(path, std::ios::binary);
  file.seekg(static_cast<std::streamoff>(offset));
  const Inflater stream = make_inflater();
  if (!stream) return fail(ErrorCode::kLimit, "{}: out of memory", path.string());

  std::vector<char> packed(1 << 18);
  std::vector<unsigned char> plain(1 << 18);
  std::uint64_t found = 0;
  for (int status = Z_OK; status != Z_STREAM_END && found < expected + kMaxSurplus;) {
    if (stream->avail_in == 0) {
      file.read(packed.data(), static_cast<std::streamsize>(packed.size()));
      stream->next_in = reinterpret_cast<unsigned char*>(packed.data());
      stream->avail_in = static_cast<unsigned>(file.gcount());
      if (stream->avail_in == 0 && found < expected) return truncated_file(path, expected, found);
      if (stream->avail_in == 0) {
        return bad_file(path,
                        "is truncated: the end of its compressed pixels, with their checksum, is missing");
      }
    }
    stream->next_out = plain.data();
    stream->avail_out = static_cast<unsigned>(plain.size());
    status = inflate(stream.get(), Z_NO_FLUSH);
    if (status != Z_OK && status != Z_STREAM_END) {
      return bad_file(path, "its compressed pixels are damaged after {} bytes ({})", found,
                      stream->msg ? stream->msg : "zlib");
    }
    found += plain.size() - stream->avail_out;
    // Gzip files may have several members (bgzip): continue with the next one.
    if (status == Z_STREAM_END && found < expected && inflateReset(stream.get()) == Z_OK) status = Z_OK;
  }
  if (found < expected) return truncated_file(path, expected, found);
  return {};
}

}  // namespace splatlas

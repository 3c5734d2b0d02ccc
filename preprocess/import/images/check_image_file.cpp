#include "preprocess/import/images/check_image_file.h"

#include <algorithm>
#include <fstream>
#include <memory>
#include <vector>

#include <zlib.h>

#include "format/grid.h"
#include "format/system/ascii_text.h"
#include "format/system/result_macros.h"
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

Result<ImageFormat> image_format(const fs::path& path) {
  const std::string name = to_lower(path.filename().string());
  if (name.ends_with(".nii") || name.ends_with(".nii.gz")) return ImageFormat::kNifti;
  if (name.ends_with(".nrrd") || name.ends_with(".nhdr")) return ImageFormat::kNrrd;
  if (name.ends_with(".mha") || name.ends_with(".mhd")) return ImageFormat::kMetaImage;
  return bad_file(path, "is of no known type; volumes end in .nii, .nii.gz, .nrrd, .nhdr, .mha or .mhd");
}

Result<void> read_deflated(const fs::path& path, std::uint64_t offset, std::span<std::byte> pixels) {
  std::ifstream file(path, std::ios::binary);
  file.seekg(static_cast<std::streamoff>(offset));
  const Inflater stream = make_inflater();
  if (!stream) return fail(ErrorCode::kLimit, "{}: out of memory", path.string());

  constexpr std::uint64_t kMaxPiece = 1u << 30;  // zlib counts in 32 bits
  std::vector<char> packed(1 << 18);
  std::vector<std::byte> surplus(1 << 18);
  std::uint64_t found = 0;
  for (int status = Z_OK; status != Z_STREAM_END && found < pixels.size() + kMaxSurplus;) {
    if (stream->avail_in == 0) {
      file.read(packed.data(), static_cast<std::streamsize>(packed.size()));
      stream->next_in = reinterpret_cast<unsigned char*>(packed.data());
      stream->avail_in = static_cast<unsigned>(file.gcount());
      if (stream->avail_in == 0 && found < pixels.size()) return truncated_file(path, pixels.size(), found);
      if (stream->avail_in == 0) {
        return bad_file(path,
                        "is truncated: the end of its compressed pixels, with their checksum, is missing");
      }
    }
    const std::span<std::byte> to = found < pixels.size()
                                        ? pixels.subspan(found, std::min(pixels.size() - found, kMaxPiece))
                                        : std::span(surplus);
    stream->next_out = reinterpret_cast<unsigned char*>(to.data());
    stream->avail_out = static_cast<unsigned>(to.size());
    status = inflate(stream.get(), Z_NO_FLUSH);
    if (status != Z_OK && status != Z_STREAM_END) {
      return bad_file(path, "its compressed pixels are damaged after {} bytes ({})", found,
                      stream->msg ? stream->msg : "zlib");
    }
    found += to.size() - stream->avail_out;
    // Gzip files may have several members (bgzip): continue with the next one.
    if (status == Z_STREAM_END && found < pixels.size() && inflateReset(stream.get()) == Z_OK) status = Z_OK;
  }
  if (found < pixels.size()) return truncated_file(path, pixels.size(), found);
  return {};
}

void swap_bytes(VoxelBuffer& voxels) {
  const auto size = static_cast<std::ptrdiff_t>(bytes_of(voxels.type));
  for (auto at = voxels.bytes.begin(); at != voxels.bytes.end(); at += size) std::reverse(at, at + size);
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

Result<void> check_raw_payload(const fs::path& path, std::uint64_t offset, std::uint64_t needed,
                               std::uint64_t expected) {
  std::error_code error;
  const std::uint64_t size = fs::file_size(path, error);
  if (error) return bad_file(path, "{}", error.message());
  const std::uint64_t found = size > offset ? size - offset : 0;
  if (found < needed) return truncated_file(path, expected, found);
  return {};
}

tl::unexpected<Error> truncated_file(const fs::path& path, std::uint64_t expected, std::uint64_t found) {
  return bad_file(path, "is truncated: its header promises {} bytes of pixels, {} are there", expected,
                  found);
}

tl::unexpected<Error> bad_pixel_type(const fs::path& path, std::string_view type) {
  return bad_file(path, "has pixels of {}; 8, 16 and 32-bit integers, float and double are read", type);
}

Result<void> check_one_volume(const fs::path& path, std::int64_t volumes) {
  if (volumes == 1) return {};
  return bad_file(path, "holds {} volumes; give one volume a file", volumes);
}

}  // namespace splatlas

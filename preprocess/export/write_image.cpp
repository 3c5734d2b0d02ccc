#include "preprocess/export/write_image.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <initializer_list>
#include <memory>
#include <new>
#include <optional>
#include <span>

#include <zlib.h>

#include "format/result_macros.h"
#include "format/tasks/task_control.h"
#include "format/text/ascii_text.h"
#include "preprocess/export/image_headers.h"
#include "preprocess/import/images/pixels/check_image_file.h"
#include "preprocess/import/import_error.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

using Bytes = std::span<const std::byte>;
/// Takes the bytes of a file, piece by piece. Not called before the header is known to hold the image.
using Sink = std::function<Result<void>(Bytes)>;

/// Compression of ITK's writers, and of masks.
constexpr int kNiftiLevel = 6, kTextHeaderLevel = 2, kMaskLevel = 1;

/// kFailed for a geometry that import_image() refuses.
Result<void> check_readable(const Grid& grid, const fs::path& path) {
  const auto refuse = [&](double mm) {
    return bad_file(path, "the volume's geometry has {:.4g} mm; files can hold at most 1e9 mm", mm);
  };
  for (std::size_t a = 0; a < 3; ++a) {
    if (std::abs(grid.origin_lps_mm[a]) > kMaxPlausible) return refuse(grid.origin_lps_mm[a]);
    for (std::size_t row = 0; row < 3; ++row) {
      const double mm = grid.spacing_mm[a] * grid.direction_lps[3 * row + a];
      if (std::abs(mm) > kMaxPlausible) return refuse(mm);
    }
  }
  return {};
}

Bytes bytes_of_text(const std::string& text) {
  return std::as_bytes(std::span(text));
}

/// Compresses the parts into one zlib stream, or a gzip file, and hands over its pieces in order.
Result<void> deflate_parts(std::initializer_list<Bytes> parts, bool gzip, int level, const fs::path& path,
                           const Sink& sink) {
  constexpr int kWindowBits = 15, kGzip = 16, kMemoryLevel = 8;
  constexpr std::size_t kMaxInput = std::size_t{1} << 30;  // zlib's counts have 32 bits
  z_stream stream{};
  if (deflateInit2(&stream, level, Z_DEFLATED, kWindowBits + (gzip ? kGzip : 0), kMemoryLevel,
                   Z_DEFAULT_STRATEGY) != Z_OK)
    return fail(ErrorCode::kLimit, "{}: cannot be written: out of memory", path.string());
  const std::unique_ptr<z_stream, int (*)(z_stream*)> end(&stream, deflateEnd);
  std::vector<std::byte> buffer(1 << 18);
  const auto pump = [&](Bytes bytes, int flush) -> Result<void> {
    stream.next_in =
        const_cast<Bytef*>(reinterpret_cast<const Bytef*>(bytes.data()));  // zlib does not change it
    stream.avail_in = static_cast<unsigned>(bytes.size());
    do {
      check_task();
      stream.next_out = reinterpret_cast<Bytef*>(buffer.data());
      stream.avail_out = static_cast<unsigned>(buffer.size());
      deflate(&stream, flush);  // cannot fail: the state is valid and there is room
      const std::size_t made = buffer.size() - stream.avail_out;
      if (made > 0) SPLATLAS_RETURN_IF_ERROR(sink(std::span(buffer).first(made)));
    } while (stream.avail_out == 0);
    return {};
  };
  for (Bytes part : parts) {
    for (; !part.empty(); part = part.subspan(std::min(part.size(), kMaxInput)))
      SPLATLAS_RETURN_IF_ERROR(pump(part.first(std::min(part.size(), kMaxInput)), Z_NO_FLUSH));
  }
  return pump({}, Z_FINISH);
}

Result<void> write_nifti(const Image& image, const fs::path& path, int level, const Sink& sink) {
  SPLATLAS_ASSIGN_OR_RETURN(const std::string header, nifti_header(image.grid, image.voxels.type, path));
  if (to_lower(path.extension().string()) == ".gz") {
    return deflate_parts({bytes_of_text(header), image.voxels.bytes}, true, level, path, sink);
  }
  SPLATLAS_RETURN_IF_ERROR(sink(bytes_of_text(header)));
  return sink(image.voxels.bytes);
}

Result<void> write_nrrd(const Image& image, const fs::path& path, const Sink& sink) {
  SPLATLAS_RETURN_IF_ERROR(sink(bytes_of_text(nrrd_header(image.grid, image.voxels.type))));
  return deflate_parts({image.voxels.bytes}, true, kTextHeaderLevel, path, sink);
}

/// The header holds the number of compressed bytes, so they are kept in memory.
Result<void> write_meta_image(const Image& image, const fs::path& path, const Sink& sink) {
  std::vector<std::vector<std::byte>> pieces;
  std::uint64_t bytes = 0;
  const auto keep = [&](Bytes piece) -> Result<void> {
    pieces.emplace_back(piece.begin(), piece.end());
    bytes += piece.size();
    return {};
  };
  SPLATLAS_RETURN_IF_ERROR(deflate_parts({image.voxels.bytes}, false, kTextHeaderLevel, path, keep));
  SPLATLAS_RETURN_IF_ERROR(sink(bytes_of_text(meta_image_header(image.grid, image.voxels.type, bytes))));
  for (const std::vector<std::byte>& piece : pieces) SPLATLAS_RETURN_IF_ERROR(sink(piece));
  return {};
}

/// Writes everything into a sink; NIfTI's compression has `level`.
Result<void> write_whole(const Image& image, const fs::path& path, int level, const Sink& sink) {
  SPLATLAS_ASSIGN_OR_RETURN(const ImageFormat format, writable_image_format(path));
  SPLATLAS_RETURN_IF_ERROR(check_readable(image.grid, path));
  try {
    switch (format) {
      case ImageFormat::kNifti: return write_nifti(image, path, level, sink);
      case ImageFormat::kNrrd: return write_nrrd(image, path, sink);
      case ImageFormat::kMetaImage: break;
    }
    return write_meta_image(image, path, sink);
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::kLimit, "{}: cannot be written: out of memory", path.string());
  }
}

}  // namespace

Result<ImageFormat> writable_image_format(const fs::path& path) {
  const std::string name = to_lower(path.filename().string());
  if (name.ends_with(".nii") || name.ends_with(".nii.gz")) return ImageFormat::kNifti;
  if (name.ends_with(".nrrd")) return ImageFormat::kNrrd;
  if (name.ends_with(".mha")) return ImageFormat::kMetaImage;
  const bool is_header = name.ends_with(".nhdr") || name.ends_with(".mhd");
  return fail(ErrorCode::kUsage, "{}: {}", path.string(),
              is_header ? fmt::format("would be two files; write {}", name.ends_with("r") ? ".nrrd" : ".mha")
                        : "is of no known type; volumes are written as .nii, .nii.gz, .nrrd or .mha");
}

Result<OutputFile> write_image(const Image& image, const fs::path& path) {
  std::optional<OutputFile> file;
  SPLATLAS_RETURN_IF_ERROR(write_whole(image, path, kNiftiLevel, [&](Bytes piece) -> Result<void> {
    if (!file) {
      SPLATLAS_ASSIGN_OR_RETURN(file, OutputFile::create(path));
    }
    return file->write(piece);
  }));
  return std::move(*file);
}

Result<std::vector<std::byte>> encode_mask_file(const Image& mask, const fs::path& path) {
  std::vector<std::byte> file;
  SPLATLAS_RETURN_IF_ERROR(write_whole(mask, path, kMaskLevel, [&](Bytes piece) -> Result<void> {
    file.insert(file.end(), piece.begin(), piece.end());
    return {};
  }));
  return file;
}

}  // namespace splatlas

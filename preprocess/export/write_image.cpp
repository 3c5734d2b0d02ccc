#include "preprocess/export/write_image.h"

#include <cmath>
#include <cstddef>
#include <functional>
#include <new>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "format/system/ascii_text.h"
#include "format/system/output_file.h"
#include "format/system/result_macros.h"
#include "preprocess/export/deflate.h"
#include "preprocess/export/image_header.h"
#include "preprocess/import/images/check_image_file.h"
#include "preprocess/import/import_error.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

using Bytes = std::span<const std::byte>;
/// Creates the file once its header is known to hold the image.
using CreateFile = std::function<Result<OutputFile>()>;

/// Compression levels of ITK's writers.
constexpr int kNiftiLevel = 6, kTextHeaderLevel = 2;

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

Result<OutputFile> write_nifti(const Image& image, const fs::path& path, const CreateFile& create) {
  SPLATLAS_ASSIGN_OR_RETURN(const std::string header, nifti_header(image.grid, image.voxels.type, path));
  SPLATLAS_ASSIGN_OR_RETURN(OutputFile file, create());
  if (to_lower(path.extension().string()) == ".gz") {
    SPLATLAS_RETURN_IF_ERROR(deflate_in_pieces({bytes_of_text(header), image.voxels.bytes},
                                               DeflateWrapper::kGzip, kNiftiLevel, path,
                                               [&](Bytes piece) { return file.write(piece); }));
  } else {
    SPLATLAS_RETURN_IF_ERROR(file.write(bytes_of_text(header)));
    SPLATLAS_RETURN_IF_ERROR(file.write(image.voxels.bytes));
  }
  return file;
}

Result<OutputFile> write_nrrd(const Image& image, const fs::path& path, const CreateFile& create) {
  const std::string header = nrrd_header(image.grid, image.voxels.type);
  SPLATLAS_ASSIGN_OR_RETURN(OutputFile file, create());
  SPLATLAS_RETURN_IF_ERROR(file.write(bytes_of_text(header)));
  SPLATLAS_RETURN_IF_ERROR(deflate_in_pieces({image.voxels.bytes}, DeflateWrapper::kGzip, kTextHeaderLevel,
                                             path, [&](Bytes piece) { return file.write(piece); }));
  return file;
}

/// The header holds the number of compressed bytes, so they are kept in memory.
Result<OutputFile> write_meta_image(const Image& image, const fs::path& path, const CreateFile& create) {
  std::vector<std::vector<std::byte>> pieces;
  std::uint64_t bytes = 0;
  const auto keep = [&](Bytes piece) -> Result<void> {
    pieces.emplace_back(piece.begin(), piece.end());
    bytes += piece.size();
    return {};
  };
  SPLATLAS_RETURN_IF_ERROR(
      deflate_in_pieces({image.voxels.bytes}, DeflateWrapper::kZlib, kTextHeaderLevel, path, keep));
  const std::string header = meta_image_header(image.grid, image.voxels.type, bytes);
  SPLATLAS_ASSIGN_OR_RETURN(OutputFile file, create());
  SPLATLAS_RETURN_IF_ERROR(file.write(bytes_of_text(header)));
  for (const std::vector<std::byte>& piece : pieces) SPLATLAS_RETURN_IF_ERROR(file.write(piece));
  return file;
}

/// Writes everything into a new file, without committing it.
Result<OutputFile> write_whole(const Image& image, const fs::path& path, const CreateFile& create) {
  SPLATLAS_ASSIGN_OR_RETURN(const ImageFormat format, writable_image_format(path));
  SPLATLAS_RETURN_IF_ERROR(check_readable(image.grid, path));
  try {
    switch (format) {
      case ImageFormat::kNifti: return write_nifti(image, path, create);
      case ImageFormat::kNrrd: return write_nrrd(image, path, create);
      case ImageFormat::kMetaImage: break;
    }
    return write_meta_image(image, path, create);
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::kLimit, "{}: cannot be written: out of memory", path.string());
  }
}

}  // namespace

Result<ImageFormat> writable_image_format(const fs::path& path) {
  Result<ImageFormat> format = image_format(path);
  const std::string ending = to_lower(path.extension().string());
  if (ending == ".nhdr" || ending == ".mhd") {
    return fail(ErrorCode::kUsage, "{}: would be two files; write {}", path.string(),
                ending == ".nhdr" ? ".nrrd" : ".mha");
  }
  if (!format) {
    return fail(ErrorCode::kUsage,
                "{}: is of no known type; volumes are written as .nii, .nii.gz, .nrrd or .mha",
                path.string());
  }
  return format;
}

Result<void> write_image(const Image& image, const fs::path& path) {
  SPLATLAS_ASSIGN_OR_RETURN(OutputFile file,
                            write_whole(image, path, [&] { return OutputFile::create(path); }));
  return file.commit();
}

Result<void> write_image(const Image& image, OutputFolder& folder, const std::string& name) {
  SPLATLAS_ASSIGN_OR_RETURN(
      OutputFile file, write_whole(image, folder.path() / name, [&] { return folder.create_file(name); }));
  return folder.add(std::move(file));
}

}  // namespace splatlas

#include "preprocess/export/write_image.h"

#include "format/system/ascii_text.h"
#include "format/system/output_file.h"
#include "format/system/result_macros.h"
#include "preprocess/import/images/check_image_file.h"
#include "preprocess/import/images/image_io.h"
#include "preprocess/import/images/itk_call.h"
#include "preprocess/import/import_error.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

Result<void> write_with(itk::ImageIOBase& io, const Image& image, const fs::path& path) {
  io.SetFileName(path.string());
  io.SetNumberOfDimensions(3);
  itk::ImageIORegion region(3);
  for (unsigned a = 0; a < 3; ++a) {
    const auto size = static_cast<itk::SizeValueType>(image.grid.size[a]);
    io.SetDimensions(a, size);
    region.SetSize(a, size);
    io.SetSpacing(a, image.grid.spacing_mm[a]);
    io.SetOrigin(a, image.grid.origin_lps_mm[a]);
    const Matrix3& direction = image.grid.direction_lps;
    io.SetDirection(a, std::vector<double>{direction[a], direction[3 + a], direction[6 + a]});
  }
  io.SetIORegion(region);
  io.SetPixelType(itk::IOPixelEnum::SCALAR);
  io.SetNumberOfComponents(1);
  io.SetComponentType(component_of(image.voxels.type));
  io.SetUseCompression(true);  // ignored by NIfTI, which compresses by file extension
  io.Write(image.voxels.bytes.data());
  return {};
}

tl::unexpected<Error> cannot_write_whole(const fs::path& path) {
  return bad_file(path, "cannot be written whole; is the disk full?");
}

/// Writes `temporary`. Messages call it `path`.
Result<void> write_quietly(ImageFormat format, const Image& image, const fs::path& temporary,
                           const fs::path& path) {
  const QuietStandardError quiet;
  Result<void> written = call_itk(path.string() + ": cannot be written",
                                  [&] { return write_with(*make_image_io(format), image, temporary); });
  // Replace the messages of the NRRD library, which are call stacks.
  if (!written && written.error().code == ErrorCode::kFailed && format == ImageFormat::kNrrd)
    return cannot_write_whole(path);
  if (!written) return fail(written.error().code, with_path(written.error().message, temporary, path));
  return written;
}

/// Compares `file` with the image. Messages call it `path`.
Result<void> compare(const Image& image, const fs::path& file, const fs::path& path) {
  const Result<Image> back = import_image(file);
  if (!back) return cannot_write_whole(path);
  if (back->voxels != image.voxels) {
    return bad_file(path, "other voxels come back than were written; write .nrrd");
  }
  if (!check_same_grid(image.grid, "", back->grid, "")) {
    return bad_file(path, "this format cannot hold the volume's geometry; write .nrrd");
  }
  return {};
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
  SPLATLAS_ASSIGN_OR_RETURN(const ImageFormat format, writable_image_format(path));
  return write_atomically(path, [&](const fs::path& temporary) -> Result<void> {
    SPLATLAS_RETURN_IF_ERROR(write_quietly(format, image, temporary, path));
    return compare(image, temporary, path);
  });
}

}  // namespace splatlas

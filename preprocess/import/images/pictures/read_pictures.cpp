#include "preprocess/import/images/pictures/read_pictures.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include <itkPNGImageIO.h>

#include "format/result_macros.h"
#include "format/text/ascii_text.h"
#include "preprocess/import/images/itk/image_io.h"
#include "preprocess/import/images/itk/itk_call.h"
#include "preprocess/import/images/pictures/brainglobe_folder.h"
#include "preprocess/import/images/pictures/check_png.h"
#include "preprocess/import/images/pictures/read_tiff.h"
#include "preprocess/import/images/pixels/check_image_file.h"
#include "preprocess/import/import_error.h"
#include "preprocess/import/isolation/run_isolated.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

const NoteKind kAssumedPictureFrame{
    "no-orientation-pictures",
    "stack of pictures has no orientation and is read with x to the left, y to the back, z upwards",
    "stacks of pictures have no orientation and are read with x to the left, y to the back, z upwards", true};

/// Orders names by the numbers in them.
bool comes_before(const std::string& a, const std::string& b) {
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (!is_digit(a[i]) || !is_digit(b[j])) {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i, ++j;
      continue;
    }
    while (i < a.size() && a[i] == '0') ++i;
    while (j < b.size() && b[j] == '0') ++j;
    const auto end_of = [&](const std::string& text, std::size_t from) {
      return static_cast<std::size_t>(
          std::find_if_not(text.begin() + static_cast<std::ptrdiff_t>(from), text.end(), is_digit) -
          text.begin());
    };
    const std::string x = a.substr(i, end_of(a, i) - i), y = b.substr(j, end_of(b, j) - j);
    if (x.size() != y.size()) return x.size() < y.size();
    if (x != y) return x < y;
    i += x.size(), j += y.size();
  }
  return a.size() - i < b.size() - j;
}

std::vector<fs::path> list_pictures(const fs::path& path) {
  std::error_code error;
  if (!fs::is_directory(path, error)) return {path};
  std::vector<fs::path> files;
  for (fs::directory_iterator entry(path, error), end; !error && entry != end; entry.increment(error)) {
    if (is_picture(entry->path())) files.push_back(entry->path());
  }
  std::ranges::sort(files, [](const fs::path& a, const fs::path& b) {
    return comes_before(a.filename().string(), b.filename().string());
  });
  return files;
}

Result<SourceImage> read_png(const fs::path& file) {
  SPLATLAS_RETURN_IF_ERROR(check_png(file));
  const itk::PNGImageIO::Pointer io = itk::PNGImageIO::New();
  if (!io->CanReadFile(file.c_str())) return bad_file(file, "is not the picture that its ending says");
  io->SetFileName(file.string());
  io->ReadImageInformation();
  if (io->GetNumberOfComponents() != 1 || io->GetPixelType() != itk::IOPixelEnum::SCALAR)
    return bad_file(file, "holds colours or a palette; convert it to grey numbers of 8 or 16 bits");
  SourceImage image;
  image.grid.size = {static_cast<std::int64_t>(io->GetDimensions(0)),
                     static_cast<std::int64_t>(io->GetDimensions(1)), 1};
  image.voxels.type = voxel_type_of(io->GetComponentType());
  SPLATLAS_ASSIGN_OR_RETURN(const std::uint64_t bytes,
                            payload_bytes(file, image.grid.size, bytes_of(image.voxels.type)));
  image.voxels.bytes.resize(bytes);
  itk::ImageIORegion region(2);
  for (unsigned a = 0; a < 2; ++a) region.SetSize(a, io->GetDimensions(a));
  io->SetIORegion(region);
  io->Read(image.voxels.bytes.data());
  return image;
}

/// Appends the slices of a file.
Result<void> add_picture(const fs::path& file, SourceImage& image) {
  report_child_progress(file);
  const bool is_png = to_lower(file.extension().string()) == ".png";
  SPLATLAS_ASSIGN_OR_RETURN(SourceImage next, is_png ? read_png(file) : read_tiff(file));
  if (image.voxels.empty()) {
    image = std::move(next);
    return {};
  }
  if (next.voxels.type != image.voxels.type || next.grid.size[0] != image.grid.size[0] ||
      next.grid.size[1] != image.grid.size[1]) {
    return bad_file(file, "has {} x {} {} pixels, but the pictures before have {} x {} {}", next.grid.size[0],
                    next.grid.size[1], name_of(next.voxels.type), image.grid.size[0], image.grid.size[1],
                    name_of(image.voxels.type));
  }
  image.grid.size[2] += next.grid.size[2];
  SPLATLAS_RETURN_IF_ERROR(payload_bytes(file, image.grid.size, bytes_of(image.voxels.type)));
  image.voxels.bytes.insert(image.voxels.bytes.end(), next.voxels.bytes.begin(), next.voxels.bytes.end());
  return {};
}

}  // namespace

bool is_picture(const fs::path& path) {
  const std::string ending = to_lower(path.extension().string());
  return ending == ".tif" || ending == ".tiff" || ending == ".png";
}

Result<SourceImage> read_pictures(const fs::path& path, const ImageOptions& options) {
  std::optional<PictureFrame> frame;
  if (!options.spacing_mm) {
    SPLATLAS_ASSIGN_OR_RETURN(frame, brainglobe_frame(path));
    if (!frame) {
      return fail(ErrorCode::kUsage,
                  "{}: pictures hold no distances; give the voxels' size in mm: --spacing X,Y,Z",
                  path.string());
    }
  }
  return call_itk(path.string(), [&]() -> Result<SourceImage> {
    SourceImage image;
    for (const fs::path& file : list_pictures(path)) SPLATLAS_RETURN_IF_ERROR(add_picture(file, image));
    if (frame) {
      image.grid.spacing_mm = frame->spacing_mm;
      image.grid.direction_lps = frame->direction_lps;
    } else {
      image.grid.spacing_mm = *options.spacing_mm;
      image.notes.add(kAssumedPictureFrame, path.string());
    }
    SPLATLAS_RETURN_IF_ERROR(validate(image.grid, path.string()));
    return image;
  });
}

}  // namespace splatlas

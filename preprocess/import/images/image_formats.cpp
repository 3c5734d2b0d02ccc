#include "preprocess/import/images/image_formats.h"

#include <algorithm>
#include <array>
#include <string>

#include "format/result_macros.h"
#include "format/text/ascii_text.h"
#include "preprocess/import/images/dicom/import_dicom.h"
#include "preprocess/import/images/itk/read_itk_image.h"
#include "preprocess/import/images/nifti/read_nifti.h"
#include "preprocess/import/images/pictures/read_pictures.h"
#include "preprocess/import/images/read_mgh.h"
#include "preprocess/import/images/transfer_image.h"
#include "preprocess/import/import_error.h"
#include "preprocess/import/isolation/run_isolated.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

bool ends_with_any(const fs::path& path, std::initializer_list<const char*> endings) {
  const std::string name = to_lower(path.filename().string());
  return std::ranges::any_of(endings, [&](const char* ending) { return name.ends_with(ending); });
}

bool is_folder(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error);
}

bool is_nifti(const fs::path& path) {
  return ends_with_any(path, {".nii", ".nii.gz", ".hdr", ".img", ".hdr.gz", ".img.gz"});
}
bool is_nrrd(const fs::path& path) {
  return ends_with_any(path, {".nrrd", ".nhdr"});
}
bool is_meta_image(const fs::path& path) {
  return ends_with_any(path, {".mha", ".mhd"});
}
bool is_mgh(const fs::path& path) {
  return ends_with_any(path, {".mgz", ".mgh", ".mgh.gz"});
}

/// True for a folder with image files of other kinds at its top: a folder of masks.
bool holds_image_files(const fs::path& folder) {
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const fs::path& file = entry->path();
    if (is_nifti(file) || is_nrrd(file) || is_meta_image(file) || is_mgh(file)) return true;
  }
  return false;
}

bool is_dicom_source(const fs::path& path) {
  return !(is_folder(path) && holds_image_files(path)) && is_dicom(path);
}

/// A folder is a stack if it holds pictures, and no images of other kinds: those may have previews beside
/// them.
bool is_picture_stack(const fs::path& path) {
  if (!is_folder(path)) return is_picture(path);
  bool has_pictures = false;
  std::error_code error;
  for (fs::directory_iterator entry(path, error), end; !error && entry != end; entry.increment(error))
    has_pictures = has_pictures || is_picture(entry->path());
  return has_pictures && !holds_image_files(path);
}

template <Result<SourceImage> (*read)(const fs::path&)>
Result<SourceImage> without_options(const fs::path& path, const ImageOptions&) {
  return read(path);
}

/// In the order in which they are tried.
constexpr std::array kFormats{
    ImageFormatEntry{"NIfTI or Analyze (.nii, .nii.gz, .hdr with .img)", is_nifti,
                     without_options<read_nifti>},
    ImageFormatEntry{"NRRD (.nrrd, .nhdr, .seg.nrrd)", is_nrrd, without_options<read_nrrd>},
    ImageFormatEntry{"MetaImage (.mha, .mhd)", is_meta_image, without_options<read_meta_image>},
    ImageFormatEntry{"FreeSurfer (.mgz, .mgh)", is_mgh, without_options<read_mgh>},
    ImageFormatEntry{"DICOM (files or a folder)", is_dicom_source, import_dicom},
    ImageFormatEntry{"TIFF or PNG, one file or a folder of slices, with --spacing", is_picture_stack,
                     read_pictures},
};

/// Remedy for a file that no reader takes.
std::string remedy_for(const fs::path& path) {
  if (ends_with_any(path, {".mnc", ".mnc.gz"})) return "convert it with mnc2nii (MINC tools) to .nii";
  if (ends_with_any(path, {".zarr", ".ome.zarr"})) return "export it as a TIFF stack or .nrrd";
  if (ends_with_any(path, {".vtk", ".vti"})) return "it has no orientation; save it as .nrrd or .mha";
  if (ends_with_any(path, {".brik", ".head", ".brik.gz"})) return "convert it with 3dAFNItoNIFTI to .nii.gz";
  if (ends_with_any(path, {".par", ".rec"})) return "convert it with dcm2niix to .nii.gz";
  if (ends_with_any(path, {".gipl", ".gipl.gz", ".mrc", ".map", ".nd2", ".czi", ".lsm"}))
    return "save it as .nrrd or .nii.gz";
  if (ends_with_any(path, {".zip", ".tar", ".tgz", ".tar.gz", ".7z"})) return "unpack it first";
  std::string list;
  for (const ImageFormatEntry& format : kFormats) list += std::string(list.empty() ? "" : "; ") + format.name;
  return "volumes and labels are read from " + list;
}

Result<const ImageFormatEntry*> known_format(const fs::path& path) {
  if (!is_folder(path)) SPLATLAS_RETURN_IF_ERROR(check_regular_file(path));
  const ImageFormatEntry* const format = find_image_format(path);
  if (format != nullptr) return format;
  if (is_folder(path)) return bad_file(path, "is a folder without images; {}", remedy_for(path));
  return bad_file(path, "is of no known type; {}", remedy_for(path));
}

}  // namespace

const ImageFormatEntry* find_image_format(const fs::path& path) {
  const auto found =
      std::ranges::find_if(kFormats, [&](const ImageFormatEntry& entry) { return entry.recognises(path); });
  return found == kFormats.end() ? nullptr : &*found;
}

Result<SourceImage> read_image_here(const fs::path& path, const ImageOptions& options) {
  SPLATLAS_ASSIGN_OR_RETURN(const ImageFormatEntry* const format, known_format(path));
  return format->read(path, options);
}

Result<SourceImage> read_image(const fs::path& path, const ImageOptions& options) {
  SPLATLAS_ASSIGN_OR_RETURN(const ImageFormatEntry* const format, known_format(path));
  if (format->read == import_dicom) load_dicom_dictionary();
  return run_isolated<SourceImage>(path, [&] { return format->read(path, options); });
}

}  // namespace splatlas

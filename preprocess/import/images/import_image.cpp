#include "preprocess/import/images/import_image.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "format/result_macros.h"
#include "format/text/ascii_text.h"
#include "preprocess/import/images/pixels/check_image_file.h"
#include "preprocess/import/images/pixels/image_readers.h"
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
  return std::ranges::any_of(visible_files(folder), [](const fs::path& file) {
    return is_nifti(file) || is_nrrd(file) || is_meta_image(file) || is_mgh(file);
  });
}

/// A folder is a stack if it holds pictures, and no other images, which may have previews beside them.
bool is_picture_stack(const fs::path& path) {
  if (!is_folder(path)) return is_picture(path);
  return std::ranges::any_of(visible_files(path), is_picture) && !holds_image_files(path);
}

/// In the order in which they are tried.
constexpr std::array kFormats{
    ImageFormatEntry{"NIfTI or Analyze (.nii, .nii.gz, .hdr with .img)", is_nifti, read_nifti},
    ImageFormatEntry{"NRRD (.nrrd, .nhdr, .seg.nrrd)", is_nrrd, read_nrrd},
    ImageFormatEntry{"MetaImage (.mha, .mhd)", is_meta_image, read_meta_image},
    ImageFormatEntry{"FreeSurfer (.mgz, .mgh)", is_mgh, read_mgh},
    ImageFormatEntry{
        "DICOM (files or a folder)",
        [](const fs::path& path) { return !(is_folder(path) && holds_image_files(path)) && is_dicom(path); },
        import_dicom},
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

Result<VoxelBuffer> choose_layer(SourceImage& image, const fs::path& path, const ImageOptions& options) {
  if (!options.component && image.layers == 1) return std::move(image.voxels);
  if (!options.component) {
    return fail(ErrorCode::kUsage, "{}: holds {} volumes; choose one with --component 1 to {}", path.string(),
                image.layers, image.layers);
  }
  const std::size_t number = *options.component;
  if (number < 1 || number > image.layers) {
    return fail(ErrorCode::kUsage, "{}: has no volume {}; --component must be from 1 to {}", path.string(),
                number, image.layers);
  }
  const std::size_t bytes = image.voxels.bytes.size() / image.layers;
  const auto first = image.voxels.bytes.begin() + static_cast<std::ptrdiff_t>((number - 1) * bytes);
  return VoxelBuffer{image.voxels.type,
                     std::vector<std::byte>(first, first + static_cast<std::ptrdiff_t>(bytes))};
}

/// Reverses axes in place.
template <typename T>
void reverse_axes(std::span<T> voxels, const Index3& size, const std::array<bool, 3>& flipped) {
  std::size_t block = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto count = static_cast<std::size_t>(size[a]);
    for (std::size_t first = 0; flipped[a] && first < voxels.size(); first += block * count) {
      for (std::size_t n = 0; n < count / 2; ++n) {
        const auto low = voxels.begin() + static_cast<std::ptrdiff_t>(first + n * block),
                   high = voxels.begin() + static_cast<std::ptrdiff_t>(first + (count - 1 - n) * block);
        std::swap_ranges(low, low + static_cast<std::ptrdiff_t>(block), high);
      }
    }
    block *= count;
  }
}

}  // namespace

const ImageFormatEntry* find_image_format(const fs::path& path) {
  const auto found =
      std::ranges::find_if(kFormats, [&](const ImageFormatEntry& entry) { return entry.recognises(path); });
  return found == kFormats.end() ? nullptr : &*found;
}

fs::path other_file(const fs::path& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return {};
  if (is_nifti(path)) return other_of_pair(path);
  if (!is_nrrd(path) && !is_meta_image(path)) return {};
  const auto pixels = is_nrrd(path) ? check_nrrd_file(path) : check_meta_image_file(path);
  return pixels ? pixels->file : fs::path();
}

Result<SourceImage> read_image(const fs::path& path, const ImageOptions& options) {
  SPLATLAS_ASSIGN_OR_RETURN(const ImageFormatEntry* const format, known_format(path));
  if (format->read == import_dicom) load_dicom_dictionary();
  return run_isolated<SourceImage>(path, [&] { return format->read(path, options); });
}

Result<Image> import_image(const fs::path& path, const ImageOptions& options, Notes& notes) {
  SPLATLAS_ASSIGN_OR_RETURN(SourceImage source, read_image(path, options));
  notes.add(source.notes);
  Image image{source.grid, {}, source.frame_of_reference};
  SPLATLAS_ASSIGN_OR_RETURN(image.voxels, choose_layer(source, path, options));
  return image;
}

Result<Image> import_image(const fs::path& path) {
  Notes ignored;
  return import_image(path, {}, ignored);
}

Result<void> check_same_grid(const Grid& a, const std::string& name_of_a, const Grid& b,
                             const std::string& name_of_b) {
  if (a.size != b.size) {
    return fail(ErrorCode::kFailed, "{} has {} voxels, {} has {}", name_of_a, fmt::join(a.size, "x"),
                name_of_b, fmt::join(b.size, "x"));
  }
  // The corners of one grid, mapped to the other, depend on spacing, origin and direction.
  constexpr double kTolerance = 1e-2;  // voxels
  const Affine to_mm = index_to_lps_mm(a), to_index = lps_mm_to_index(b);
  for (int corner = 0; corner < 8; ++corner) {
    Vec3 index;
    for (std::size_t n = 0; n < 3; ++n)
      index[n] = (corner >> n & 1) != 0 ? static_cast<double>(a.size[n] - 1) : 0.0;
    const Vec3 found = to_index.apply(to_mm.apply(index));
    for (std::size_t n = 0; n < 3; ++n) {
      if (std::abs(found[n] - index[n]) <= kTolerance) continue;
      return fail(ErrorCode::kFailed,
                  "{} and {} lie elsewhere: voxel ({}) of the first is at ({:.4g}) of the second", name_of_a,
                  name_of_b, fmt::join(index, ", "), fmt::join(found, ", "));
    }
  }
  return {};
}

bool have_same_voxels(const Grid& a, const Grid& b) {
  return check_same_grid(reordered(a, storage_order(a)), "", reordered(b, storage_order(b)), "").has_value();
}

VoxelBuffer to_storage_order(VoxelBuffer voxels, const Grid& source_grid) {
  const AxisOrder order = storage_order(source_grid);
  if (order.from == AxisOrder{}.from) {  // saves the memory of a copy
    visit_voxel_type(voxels.type, [&]<typename T>(T) {
      reverse_axes(std::span(voxels.as<T>(), voxels.bytes.size() / sizeof(T)), source_grid.size,
                   order.flipped);
    });
    return voxels;
  }
  VoxelBuffer stored{voxels.type, std::vector<std::byte>(voxels.bytes.size())};
  reorder_voxels(voxels.bytes.data(), source_grid.size, order, bytes_of(voxels.type), stored.bytes.data());
  return stored;
}

std::vector<std::uint8_t> mask_of(const VoxelBuffer& voxels) {
  return visit_voxel_type(voxels.type, [&]<typename T>(T) {
    const T* values = voxels.as<T>();
    std::vector<std::uint8_t> mask(voxels.bytes.size() / sizeof(T));
    for (std::size_t v = 0; v < mask.size(); ++v) mask[v] = values[v] > T(0) || values[v] < T(0);
    return mask;
  });
}

}  // namespace splatlas

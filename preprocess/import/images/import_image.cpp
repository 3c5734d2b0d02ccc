#include "preprocess/import/images/import_image.h"

#include <algorithm>
#include <cmath>
#include <span>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "format/system/result_macros.h"
#include "preprocess/import/images/check_image_file.h"
#include "preprocess/import/images/image_io.h"
#include "preprocess/import/images/itk_call.h"
#include "preprocess/import/images/read_deflated.h"
#include "preprocess/import/images/read_nifti_file.h"
#include "preprocess/import/import_error.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

Result<void> check_pixels(const itk::ImageIOBase& io, const fs::path& path) {
  if (io.GetNumberOfComponents() != 1) {
    return bad_file(path, "has {} values a voxel (colour or vectors); one is needed",
                    io.GetNumberOfComponents());
  }
  if (voxel_type_of(io.GetComponentType()) == VoxelType::kNone) {
    return bad_pixel_type(path, "type " + itk::ImageIOBase::GetComponentTypeAsString(io.GetComponentType()));
  }
  for (unsigned a = 3; a < io.GetNumberOfDimensions(); ++a) {
    SPLATLAS_RETURN_IF_ERROR(check_one_volume(path, static_cast<std::int64_t>(io.GetDimensions(a))));
  }
  return {};
}

/// ITK reads the header and plain pixels. MetaIO ignores damage in compressed ones.
Result<Image> read_with(itk::ImageIOBase& io, const fs::path& path, const PixelData& pixels) {
  const std::string name = path.string();
  if (!io.CanReadFile(name.c_str())) return bad_file(path, "is not of the type that its ending says");
  io.SetFileName(name);
  io.ReadImageInformation();
  SPLATLAS_RETURN_IF_ERROR(check_pixels(io, path));
  Image image;
  image.grid = grid_of(io);
  SPLATLAS_RETURN_IF_ERROR(validate(image.grid, name));

  image.voxels.type = voxel_type_of(io.GetComponentType());
  const std::size_t bytes = static_cast<std::size_t>(image.grid.voxels()) * bytes_of(image.voxels.type);
  if (pixels.is_deflated) {
    if (pixels.bytes != bytes)
      return bad_file(path, "has {} bytes of pixels by its header, {} by ITK's reading", pixels.bytes, bytes);
    SPLATLAS_RETURN_IF_ERROR(
        read_deflated(pixels.file, pixels.start, pixels.skipped_bytes + bytes, image.voxels.bytes));
    image.voxels.bytes.erase(image.voxels.bytes.begin(),
                             image.voxels.bytes.begin() + static_cast<std::ptrdiff_t>(pixels.skipped_bytes));
    if (pixels.is_big_endian) swap_bytes(image.voxels);
    return image;
  }
  image.voxels.bytes.resize(bytes);
  itk::ImageIORegion region(io.GetNumberOfDimensions());
  for (unsigned a = 0; a < io.GetNumberOfDimensions(); ++a) region.SetSize(a, io.GetDimensions(a));
  io.SetIORegion(region);
  io.Read(image.voxels.bytes.data());
  return image;
}

}  // namespace

Result<Image> import_image(const fs::path& path) {
  SPLATLAS_RETURN_IF_ERROR(check_regular_file(path));
  SPLATLAS_ASSIGN_OR_RETURN(const ImageFormat format, image_format(path));
  const QuietStandardError quiet;
  return call_itk(path.string(), [&]() -> Result<Image> {
    if (format == ImageFormat::kNifti) return read_nifti_file(path);
    SPLATLAS_ASSIGN_OR_RETURN(const PixelData pixels, format == ImageFormat::kNrrd
                                                          ? check_nrrd_file(path)
                                                          : check_meta_image_file(path));
    return read_with(*make_image_io(format), path, pixels);
  });
}

Result<void> check_same_grid(const Grid& a, const std::string& name_of_a, const Grid& b,
                             const std::string& name_of_b) {
  if (a.size != b.size) {
    return fail(ErrorCode::kFailed, "{} has {} voxels but {} has {}: both must be on one grid", name_of_a,
                fmt::join(a.size, "x"), name_of_b, fmt::join(b.size, "x"));
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

VoxelBuffer to_storage_order(VoxelBuffer voxels, const Grid& source_grid) {
  const AxisOrder order = storage_order(source_grid);
  if (order.is_identity()) return voxels;
  VoxelBuffer stored{voxels.type, std::vector<std::byte>(voxels.bytes.size())};
  reorder_voxels(voxels.bytes.data(), source_grid.size, order, bytes_of(voxels.type), stored.bytes.data());
  return stored;
}

bool holds_several_values(const VoxelBuffer& voxels) {
  return visit_voxel_type(voxels.type, [&]<typename T>(T) {
    const std::span values(voxels.as<T>(), voxels.bytes.size() / sizeof(T));
    const auto inside = [](T value) { return value > T(0) || value < T(0); };
    const auto first = std::ranges::find_if(values, inside);
    return first != values.end() && std::any_of(first, values.end(), [&](T value) {
             return inside(value) && (value < *first || value > *first);
           });
  });
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

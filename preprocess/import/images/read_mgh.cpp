#include <algorithm>
#include <array>
#include <bit>

#include "format/result_macros.h"
#include "preprocess/import/images/nifti/nifti_header.h"
#include "preprocess/import/images/pixels/check_image_file.h"
#include "preprocess/import/images/pixels/image_readers.h"
#include "preprocess/import/images/pixels/read_deflated.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

static_assert(std::endian::native == std::endian::little, "MGH files are big-endian");

constexpr std::size_t kHeaderBytes = 284;

Result<VoxelType> mgh_type(std::int32_t type, const fs::path& path) {
  switch (type) {
    case 0: return VoxelType::kUInt8;
    case 1: return VoxelType::kInt32;
    case 3: return VoxelType::kFloat32;
    case 4: return VoxelType::kInt16;
    case 10: return VoxelType::kUInt16;
    default: return bad_pixel_type(path, fmt::format("MGH type {}", type));
  }
}

/// The affine from indices to RAS mm: spacing, axes and the position of the centre, index size / 2.
Result<Grid> mgh_grid(const Fields& header, const Index3& size, const fs::path& path, Notes& notes) {
  std::array<float, 3> spacing{1, 1, 1}, center{0, 0, 0};
  std::array<float, 9> axes{-1, 0, 0, 0, 0, -1, 0, 1, 0};  // x, y and z, each as r, a and s
  if (header.get<std::int16_t>(28) > 0) {
    header.get_all<float>(30, spacing);
    header.get_all<float>(42, axes);
    header.get_all<float>(78, center);
  } else {
    notes.add("no-orientation-mgh", path.string());
  }
  std::array<double, 12> affine{};
  for (std::size_t row = 0; row < 3; ++row) {
    affine[4 * row + 3] = double{center[row]};
    for (std::size_t a = 0; a < 3; ++a) {
      affine[4 * row + a] = double{axes[3 * a + row]} * double{spacing[a]};
      affine[4 * row + 3] -= affine[4 * row + a] * static_cast<double>(size[a]) / 2;
    }
  }
  if (!std::ranges::all_of(affine, is_plausible) ||
      !std::ranges::all_of(spacing, [](float mm) { return mm > 0; }))
    return bad_file(path, "has a geometry (spacing, axes, centre) that cannot be");
  for (std::size_t a = 0; a < 3; ++a) {
    const float length = std::hypot(axes[3 * a], axes[3 * a + 1], axes[3 * a + 2]);
    if (std::abs(length - 1) > 0.01f)
      return bad_file(path, "has axis {} of length {}; direction cosines have length 1", a + 1, length);
  }
  Grid grid = grid_of_ras_affine(size, affine);
  for (std::size_t a = 0; a < 3; ++a) grid.spacing_mm[a] = double{spacing[a]};
  SPLATLAS_RETURN_IF_ERROR(validate(grid, path.string()));
  return grid;
}

}  // namespace

Result<SourceImage> read_mgh(const fs::path& path, const ImageOptions& /*options*/) {
  SPLATLAS_ASSIGN_OR_RETURN(GzipFile file, GzipFile::open(path));
  std::vector<std::byte> head(kHeaderBytes);
  SPLATLAS_ASSIGN_OR_RETURN(const std::size_t found, file.read_some(head));
  const Fields header(head, /*is_swapped=*/true);
  if (found < kHeaderBytes || header.get<std::int32_t>(0) != 1)
    return bad_file(path, "is not an MGH file (no version 1 at its start)");
  std::array<std::int64_t, 4> sizes{};  // the last one counts frames
  header.get_all<std::int32_t>(4, sizes);
  if (sizes[0] > 1024 && sizes[1] == 1 && sizes[2] == 1)
    return bad_file(path, "holds {} values of the vertices of a surface, and no volume", sizes[0]);

  SourceImage image;
  SPLATLAS_ASSIGN_OR_RETURN(image.voxels.type, mgh_type(header.get<std::int32_t>(20), path));
  SPLATLAS_ASSIGN_OR_RETURN(const std::uint64_t bytes,
                            payload_bytes(path, sizes, bytes_of(image.voxels.type)));
  SPLATLAS_RETURN_IF_ERROR(
      check_raw_payload(path, 0, bytes / (file.is_compressed() ? kMaxDeflateRatio : 1), bytes));
  image.layers = static_cast<std::size_t>(sizes[3]);
  SPLATLAS_ASSIGN_OR_RETURN(image.grid, mgh_grid(header, {sizes[0], sizes[1], sizes[2]}, path, image.notes));
  SPLATLAS_ASSIGN_OR_RETURN(image.voxels.bytes, file.read(kHeaderBytes, bytes));
  SPLATLAS_RETURN_IF_ERROR(file.check_end());
  swap_bytes(image.voxels.bytes, bytes_of(image.voxels.type));
  return image;
}

}  // namespace splatlas

#include "preprocess/import/images/import_image.h"

#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "format/result_macros.h"
#include "preprocess/import/images/image_formats.h"
#include "preprocess/import/import_error.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

/// The chosen layer of a file.
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

}  // namespace

Result<Image> import_image(const fs::path& path, const ImageOptions& options, Notes& notes) {
  SPLATLAS_ASSIGN_OR_RETURN(SourceImage source, read_image(path, options));
  notes.add(source.notes);
  Image image{source.grid, {}};
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
  if (order.is_identity()) return voxels;
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

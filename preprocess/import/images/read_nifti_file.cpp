#include "preprocess/import/images/read_nifti_file.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <itkNiftiImageIO.h>
#include <vnl/vnl_inverse.h>
#include <vnl/vnl_matrix_fixed.h>

#include "format/system/result_macros.h"
#include "preprocess/import/images/gzip_file.h"
#include "preprocess/import/images/image_io.h"
#include "preprocess/import/images/nifti_header.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

using Matrix = vnl_matrix_fixed<double, 3, 3>;

/// The columns of the sform in LPS, of length 1; nothing when they do not stand at right angles.
std::optional<Matrix> directions_of_sform(const NiftiHeader& header) {
  constexpr double kRounding = 1e-4;  // ITK's own
  constexpr Vec3 kRasToLps{-1, -1, 1};
  Matrix columns;
  for (unsigned row = 0; row < 3; ++row) {
    for (unsigned a = 0; a < 3; ++a) columns(row, a) = kRasToLps[row] * double{header.sform(row, a)};
  }
  for (unsigned a = 0; a < 3; ++a) {
    const double length = columns.get_column(a).magnitude();
    if (!(length > 0)) return std::nullopt;
    columns.scale_column(a, 1 / length);
  }
  const Matrix products = columns.transpose() * columns;
  if (!products.is_identity(kRounding)) return std::nullopt;
  return columns;
}

/// The orthogonal factor of the polar decomposition, by Newton's iteration (Higham 1986). It converges
/// quadratically: from 1e-4 three steps reach the precision of doubles. Signed permutations stay exact.
Matrix nearest_orthonormal(Matrix m) {
  for (int step = 0; step < 3; ++step) m = 0.5 * (m + vnl_inverse_transpose(m));
  return m;
}

/// What an sform alone says, where it is a rotation with spacings; nothing otherwise.
std::optional<Grid> grid_of_sform(const NiftiHeader& header) {
  if (header.has_qform() || !header.has_sform() || !header.in_mm() || header.dim(0) < 3) return std::nullopt;
  const std::optional<Matrix> columns = directions_of_sform(header);
  if (!columns) return std::nullopt;
  const Matrix direction = nearest_orthonormal(*columns);
  Grid grid;
  for (unsigned a = 0; a < 3; ++a) {
    grid.size[a] = header.dim(a + 1);
    grid.spacing_mm[a] = header.spacing(a + 1);
    grid.origin_lps_mm[a] = (a < 2 ? -1.0 : 1.0) * double{header.sform(a, 3)} + 0.0;
    // + 0.0: no negative zeros, which would make equal grids print differently.
    for (unsigned row = 0; row < 3; ++row) grid.direction_lps[3 * row + a] = direction(row, a) + 0.0;
  }
  return grid;
}

Grid grid_by_itk(const fs::path& path) {
  const itk::NiftiImageIO::Pointer io = itk::NiftiImageIO::New();
  io->SetFileName(path.string());
  io->ReadImageInformation();
  return grid_of(*io);
}

void swap_bytes(VoxelBuffer& voxels) {
  const std::size_t size = bytes_of(voxels.type);
  for (auto at = voxels.bytes.begin(); at != voxels.bytes.end(); at += static_cast<std::ptrdiff_t>(size)) {
    std::reverse(at, at + static_cast<std::ptrdiff_t>(size));
  }
}

VoxelBuffer scaled(const VoxelBuffer& voxels, double slope, double intercept) {
  const bool is_double = voxels.type == VoxelType::kFloat64;
  VoxelBuffer result{is_double ? VoxelType::kFloat64 : VoxelType::kFloat32, {}};
  const std::size_t count = voxels.bytes.size() / bytes_of(voxels.type);
  result.bytes.resize(count * bytes_of(result.type));
  visit_voxel_type(voxels.type, [&]<typename T>(T) {
    for (std::size_t v = 0; v < count; ++v) {
      const double value = static_cast<double>(voxels.as<T>()[v]) * slope + intercept;
      if (is_double) {
        result.as<double>()[v] = value;
      } else {
        result.as<float>()[v] = static_cast<float>(value);
      }
    }
  });
  return result;
}

Result<VoxelBuffer> read_voxels(const fs::path& path, const NiftiHeader& header, std::size_t count) {
  VoxelBuffer voxels{header.voxel_type(), {}};
  voxels.bytes.resize(count * bytes_of(voxels.type));
  const GzipFile file = open_gzip_file(path);
  const auto start = static_cast<z_off_t>(header.voxel_offset());
  if (!file || gzseek(file.get(), start, SEEK_SET) != start || !read_all(*file, voxels.bytes)) {
    return fail(ErrorCode::kFailed, fmt::format("{}: its pixels cannot be read", path.string()));
  }
  if (header.swapped()) swap_bytes(voxels);
  // A slope of 0 says that nothing is scaled.
  const bool is_scaled = header.slope() < 0 || header.slope() > 0;
  const bool is_identity =
      !(header.slope() < 1 || header.slope() > 1) && std::fpclassify(header.intercept()) == FP_ZERO;
  if (is_scaled && !is_identity) return scaled(voxels, header.slope(), header.intercept());
  return voxels;
}

}  // namespace

Result<Image> read_nifti_file(const fs::path& path) {
  const std::optional<NiftiFile> file = read_nifti_header(path);
  if (!file) return fail(ErrorCode::kFailed, fmt::format("{}: is not a NIfTI file", path.string()));
  Image image;
  const std::optional<Grid> grid = grid_of_sform(file->header);
  image.grid = grid ? *grid : grid_by_itk(path);
  SPLATLAS_RETURN_IF_ERROR(validate(image.grid, path.string()));
  SPLATLAS_ASSIGN_OR_RETURN(image.voxels,
                            read_voxels(path, file->header, static_cast<std::size_t>(image.grid.voxels())));
  return image;
}

}  // namespace splatlas

#include "preprocess/import/images/read_nifti_file.h"

#include <optional>

#include <itkNiftiImageIO.h>
#include <vnl/vnl_inverse.h>
#include <vnl/vnl_matrix_fixed.h>

#include "format/system/result_macros.h"
#include "preprocess/import/images/image_io.h"
#include "preprocess/import/images/itk_call.h"
#include "preprocess/import/images/nifti_file.h"
#include "preprocess/import/import_error.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

using Matrix = vnl_matrix_fixed<double, 3, 3>;

/// Unit columns of the sform in LPS; nothing if they are not orthogonal.
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

/// The grid of an sform without a qform, if it is a rotation with spacings.
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
    // + 0.0 turns -0 into 0, so that equal grids print alike.
    for (unsigned row = 0; row < 3; ++row) grid.direction_lps[3 * row + a] = direction(row, a) + 0.0;
  }
  return grid;
}

Result<Grid> grid_by_itk(const fs::path& path) {
  const itk::NiftiImageIO::Pointer io = itk::NiftiImageIO::New();
  io->SetFileName(path.string());
  try {
    io->ReadImageInformation();
  } catch (const itk::ExceptionObject& error) {
    if (message_of(error).find("orthonormal") == std::string::npos) throw;
    return bad_file(
        path,
        "has sheared axes (sform), but ITK's axes of NIfTI files must be orthonormal; resample it to "
        "orthogonal axes, or convert it to NRRD, which can hold sheared ones");
  }
  return grid_of(*io);
}

}  // namespace

Result<Image> read_nifti_file(const fs::path& path) {
  SPLATLAS_ASSIGN_OR_RETURN(NiftiFile file, NiftiFile::open(path));
  const std::optional<Grid> grid = grid_of_sform(file.header());
  Image image;
  SPLATLAS_ASSIGN_OR_RETURN(image.grid, grid ? *grid : grid_by_itk(path));
  SPLATLAS_RETURN_IF_ERROR(validate(image.grid, path.string()));
  SPLATLAS_ASSIGN_OR_RETURN(image.voxels, file.read_voxels());
  return image;
}

}  // namespace splatlas

// Headers of volume files: NIfTI-1, NRRD and MetaImage.
#include "preprocess/export/image_headers.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nifti1_io.h>
#include <vnl/algo/vnl_determinant.h>
#include <vnl/algo/vnl_matrix_inverse.h>
#include <vnl/vnl_matrix_fixed.h>
#include <vnl/vnl_vector_fixed.h>

#include "format/result_macros.h"
#include "preprocess/import/images/import_image.h"
#include "preprocess/import/images/pixels/check_image_file.h"
#include "preprocess/import/import_error.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::int16_t, 9> kTypes{DT_NONE,   DT_UINT8, DT_INT8,    DT_UINT16, DT_INT16,
                                             DT_UINT32, DT_INT32, DT_FLOAT32, DT_FLOAT64};

/// The nearest orthonormal axes and the origin, in RAS.
mat44 orthonormal_axes_ras(const Grid& grid) {
  const auto ras = [&](std::size_t row, std::size_t axis) {
    const auto number = static_cast<float>(grid.direction_lps[3 * row + axis]);
    return row < 2 ? -number : number;
  };
  const mat44 rows = nifti_make_orthog_mat44(ras(0, 0), ras(1, 0), ras(2, 0), ras(0, 1), ras(1, 1), ras(2, 1),
                                             ras(0, 2), ras(1, 2), ras(2, 2));
  mat44 axes = rows;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t a = 0; a < 3; ++a) axes.m[row][a] = rows.m[a][row];
    const auto origin = static_cast<float>(grid.origin_lps_mm[row]);
    axes.m[row][3] = row < 2 ? -origin : origin;
  }
  return axes;
}

/// The map from voxel indices.
mat44 scaled_axes(const mat44& axes, const Grid& grid) {
  mat44 scaled = axes;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t a = 0; a < 3; ++a) scaled.m[row][a] *= static_cast<float>(grid.spacing_mm[a]);
  }
  return scaled;
}

/// Replaces a number that is too small for is_plausible() by 0.
void make_plausible(float& number) {
  if (std::abs(number) < 1e-36f) number = std::copysign(0.f, number);
}

nifti_1_header make_header(const Grid& grid, VoxelType type) {
  nifti_1_header h{};
  h.sizeof_hdr = sizeof(h);
  h.regular = 'r';
  std::fill_n(h.dim, 8, std::int16_t{1});
  h.dim[0] = 3;
  for (std::size_t a = 0; a < 3; ++a) {
    h.dim[a + 1] = static_cast<std::int16_t>(grid.size[a]);
    h.pixdim[a + 1] = static_cast<float>(grid.spacing_mm[a]);
  }
  h.datatype = kTypes[static_cast<std::size_t>(type)];
  h.bitpix = static_cast<std::int16_t>(8 * bytes_of(type));
  h.vox_offset = sizeof(h) + 4;  // behind the empty list of extensions
  h.scl_slope = 1;
  h.xyzt_units = NIFTI_UNITS_MM;
  std::copy_n("n+1", 4, h.magic);

  const mat44 axes = orthonormal_axes_ras(grid);
  h.qform_code = h.sform_code = NIFTI_XFORM_SCANNER_ANAT;
  nifti_mat44_to_quatern(axes, &h.quatern_b, &h.quatern_c, &h.quatern_d, &h.qoffset_x, &h.qoffset_y,
                         &h.qoffset_z, nullptr, nullptr, nullptr, &h.pixdim[0]);
  const mat44 sform = scaled_axes(axes, grid);
  std::copy_n(sform.m[0], 4, h.srow_x);
  std::copy_n(sform.m[1], 4, h.srow_y);
  std::copy_n(sform.m[2], 4, h.srow_z);
  for (float* const number :
       {&h.quatern_b, &h.quatern_c, &h.quatern_d, &h.qoffset_x, &h.qoffset_y, &h.qoffset_z})
    make_plausible(*number);
  for (float* const row : {h.srow_x, h.srow_y, h.srow_z}) std::for_each_n(row, 4, make_plausible);
  return h;
}

mat44 sform_of(const nifti_1_header& h) {
  mat44 sform{};
  std::copy_n(h.srow_x, 4, sform.m[0]);
  std::copy_n(h.srow_y, 4, sform.m[1]);
  std::copy_n(h.srow_z, 4, sform.m[2]);
  sform.m[3][3] = 1;
  return sform;
}

mat44 qform_of(const nifti_1_header& h) {
  return nifti_quatern_to_mat44(h.quatern_b, h.quatern_c, h.quatern_d, h.qoffset_x, h.qoffset_y, h.qoffset_z,
                                h.pixdim[1], h.pixdim[2], h.pixdim[3], h.pixdim[0]);
}

using Matrix = vnl_matrix_fixed<float, 3, 3>;
using Affine4 = vnl_matrix_fixed<float, 4, 4>;

Matrix linear_part(const Affine4& affine) {
  return affine.extract(3, 3, 0, 0);
}

/// True if single precision suffices to invert the sform, and its columns have the lengths of the spacings.
bool is_well_conditioned(const Affine4& sform, const nifti_1_header& h) {
  if (std::abs(vnl_determinant(sform)) <= 1e-5) return false;
  const Matrix linear = linear_part(sform);
  const Affine4 inverse = vnl_matrix_inverse<float>(sform.as_matrix()).as_matrix();
  const Matrix inverse_linear = vnl_matrix_inverse<float>(linear.as_matrix()).as_matrix();
  const vnl_vector_fixed<float, 3> offset(inverse[0][3], inverse[1][3], inverse[2][3]);
  const vnl_vector_fixed<float, 3> origin(sform[0][3], sform[1][3], sform[2][3]);
  constexpr float kMaxDifference = 1e-2f;
  if ((linear_part(inverse) - inverse_linear).array_one_norm() > kMaxDifference) return false;
  if ((offset + inverse_linear * origin).one_norm() > kMaxDifference) return false;
  constexpr float kMaxSpacingDifference = 1e-3f;
  for (unsigned a = 0; a < 3; ++a) {
    const float length = linear.get_column(a).magnitude();
    if (std::abs(h.pixdim[a + 1] - length) > kMaxSpacingDifference) return false;
  }
  return true;
}

/// True if ITK reads the sform, false for the qform, whose rotation is less exact. Limits are ITK 5.2's.
bool itk_reads_sform(const mat44& sform, const mat44& qform, const nifti_1_header& h) {
  const Affine4 s(&sform.m[0][0]), q(&qform.m[0][0]);  // with the same origin
  return linear_part(s).is_equal(linear_part(q), 1e-5) || is_well_conditioned(s, h);
}

/// The grid that ITK reads from a header.
Grid grid_of(const nifti_1_header& h) {
  const mat44 sform = sform_of(h), qform = qform_of(h);
  const mat44 to_ras = itk_reads_sform(sform, qform, h) ? sform : qform;
  Grid grid;
  for (std::size_t a = 0; a < 3; ++a) {
    grid.size[a] = h.dim[a + 1];
    grid.spacing_mm[a] = h.pixdim[a + 1];
    const double length = std::hypot(to_ras.m[0][a], to_ras.m[1][a], to_ras.m[2][a]);
    for (std::size_t row = 0; row < 3; ++row)
      grid.direction_lps[3 * row + a] = (row < 2 ? -1 : 1) * double{to_ras.m[row][a]} / length;
    grid.origin_lps_mm[a] = (a < 2 ? -1 : 1) * double{to_ras.m[a][3]};
  }
  return grid;
}

/// True if import_image() reads the grid from the header.
bool holds(const nifti_1_header& h, const Grid& grid) {
  const Grid read = grid_of(h);
  const mat44 sform = sform_of(h);
  return std::ranges::all_of(sform.m,
                             [](const auto& row) { return std::ranges::all_of(row, is_plausible); }) &&
         validate(read, "") && check_same_grid(grid, "", read, "");
}

// Headers of NRRD and MetaImage files.

static_assert(std::endian::native == std::endian::little, "voxels are written in the order of the machine");

/// Names by the number of a VoxelType.
using TypeNames = std::array<const char*, 9>;
constexpr TypeNames kNrrdTypes{
    "", "unsigned char", "signed char", "unsigned short", "short", "unsigned int", "int", "float", "double"};
constexpr TypeNames kMetaTypes{"",         "MET_UCHAR", "MET_CHAR",  "MET_USHORT", "MET_SHORT",
                               "MET_UINT", "MET_INT",   "MET_FLOAT", "MET_DOUBLE"};

const char* name_in(const TypeNames& names, VoxelType type) {
  return names[static_cast<std::size_t>(type)];
}

/// Replaces -0, and numbers that are too small for is_plausible(), by 0.
template <std::size_t kCount>
std::array<double, kCount> plausible(std::array<double, kCount> numbers) {
  for (double& number : numbers) {
    if (!(std::abs(number) > 1e-36)) number = 0;
  }
  return numbers;
}

/// Column `axis` of the direction matrix, times `scale`.
Vec3 scaled_direction(const Grid& grid, std::size_t axis, double scale) {
  const Matrix3& direction = grid.direction_lps;
  return plausible(Vec3{scale * direction[axis], scale * direction[3 + axis], scale * direction[6 + axis]});
}

}  // namespace

Result<std::string> nifti_header(const Grid& grid, VoxelType type, const fs::path& path) {
  constexpr std::int64_t kMaxSize = std::numeric_limits<std::int16_t>::max();
  if (std::ranges::max(grid.size) > kMaxSize) {
    return bad_file(path, "this format cannot hold {} voxels: at most {} along an axis; write .nrrd",
                    fmt::join(grid.size, " x "), kMaxSize);
  }
  const nifti_1_header header = make_header(grid, type);
  if (!holds(header, grid))
    return bad_file(path, "this format cannot hold the volume's geometry; write .nrrd");
  std::string bytes(sizeof(header) + 4, '\0');
  std::memcpy(bytes.data(), &header, sizeof(header));
  return bytes;
}

std::string nrrd_header(const Grid& grid, VoxelType type) {
  const auto direction = [&](std::size_t axis) {
    return fmt::format("({})", fmt::join(scaled_direction(grid, axis, grid.spacing_mm[axis]), ","));
  };
  return fmt::format(
      "NRRD0004\n"
      "# Complete NRRD file format specification at:\n"
      "# http://teem.sourceforge.net/nrrd/format.html\n"
      "type: {}\n"
      "dimension: 3\n"
      "space: left-posterior-superior\n"
      "sizes: {}\n"
      "space directions: {} {} {}\n"
      "kinds: domain domain domain\n"
      "endian: little\n"
      "encoding: gzip\n"
      "space origin: ({})\n"
      "\n",
      name_in(kNrrdTypes, type), fmt::join(grid.size, " "), direction(0), direction(1), direction(2),
      fmt::join(plausible(grid.origin_lps_mm), ","));
}

std::string meta_image_header(const Grid& grid, VoxelType type, std::uint64_t compressed_bytes) {
  const auto direction = [&](std::size_t axis) {
    return fmt::format("{}", fmt::join(scaled_direction(grid, axis, 1), " "));
  };
  return fmt::format(
      "ObjectType = Image\n"
      "NDims = 3\n"
      "BinaryData = True\n"
      "BinaryDataByteOrderMSB = False\n"
      "CompressedData = True\n"
      "CompressedDataSize = {}\n"
      "TransformMatrix = {} {} {}\n"
      "Offset = {}\n"
      "CenterOfRotation = 0 0 0\n"
      "ElementSpacing = {}\n"
      "DimSize = {}\n"
      "ElementType = {}\n"
      "ElementDataFile = LOCAL\n",
      compressed_bytes, direction(0), direction(1), direction(2),
      fmt::join(plausible(grid.origin_lps_mm), " "), fmt::join(grid.spacing_mm, " "),
      fmt::join(grid.size, " "), name_in(kMetaTypes, type));
}

}  // namespace splatlas

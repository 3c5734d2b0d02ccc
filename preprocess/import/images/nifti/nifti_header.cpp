#include "preprocess/import/images/nifti/nifti_header.h"

#include <cmath>
#include <string_view>

#include <fmt/format.h>
#include <vtkMath.h>

#include "format/result_macros.h"
#include "preprocess/import/images/pixels/check_image_file.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

using Affine12 = std::array<double, 12>;

/// The magnitude of a spacing; negative ones occur.
double spacing(const NiftiHeader& header, std::size_t axis) {
  return axis < static_cast<std::size_t>(header.dim[0]) ? std::abs(header.pixdim[axis + 1]) : 1.0;
}

/// The rotation of a quaternion, times the spacings (nifti1.h, method 2).
Affine12 affine_of_qform(const NiftiHeader& header) {
  const auto [b, c, d] = header.quaternion;
  const double rest = 1 - (b * b + c * c + d * d);  // rounded numbers may exceed a length of 1
  const std::array<double, 4> quaternion{rest < 1e-7 ? 0 : std::sqrt(rest), b, c, d};
  double rotation[3][3];
  vtkMath::QuaternionToMatrix3x3(quaternion.data(), rotation);
  const double qfac = header.pixdim[0] < 0 ? -1 : 1;
  Affine12 affine{};
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t axis = 0; axis < 3; ++axis)
      affine[4 * row + axis] = rotation[row][axis] * spacing(header, axis) * (axis == 2 ? qfac : 1);
    affine[4 * row + 3] = header.qform_offset[row];
  }
  return affine;
}

/// nibabel's guess: x to the left, the centre at the origin.
Affine12 affine_without_orientation(const NiftiHeader& header) {
  Affine12 affine{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double step = axis == 0 ? -spacing(header, 0) : spacing(header, axis);
    const auto size = static_cast<double>(std::max<std::int64_t>(header.dim[axis + 1], 1));
    affine[5 * axis] = step;
    affine[4 * axis + 3] = -step * (size - 1) / 2;
  }
  return affine;
}

Matrix3 columns_of(const Affine12& affine) {
  return {affine[0], affine[1], affine[2], affine[4], affine[5], affine[6], affine[8], affine[9], affine[10]};
}

double length_of_column(const Matrix3& m, std::size_t a) {
  return std::hypot(m[a], m[3 + a], m[6 + a]);
}

bool is_singular(const Affine12& affine) {
  const Matrix3 columns = columns_of(affine);
  double volume = 1;
  for (std::size_t a = 0; a < 3; ++a) volume *= length_of_column(columns, a);
  constexpr double kFlat = 1e-6;
  return !(std::abs(determinant(columns)) > kFlat * volume);
}

/// Largest distance in mm between the corners of the volume in two frames.
double largest_distance(const NiftiHeader& header, const Affine12& first, const Affine12& second) {
  double largest = 0;
  for (int corner = 0; corner < 8; ++corner) {
    Vec3 apart;
    for (std::size_t row = 0; row < 3; ++row) {
      apart[row] = first[4 * row + 3] - second[4 * row + 3];
      for (std::size_t a = 0; a < 3; ++a) {
        const auto last = static_cast<double>(header.dim[a + 1] - 1);
        if ((corner >> a & 1) != 0) apart[row] += (first[4 * row + a] - second[4 * row + a]) * last;
      }
    }
    largest = std::max(largest, std::hypot(apart[0], apart[1], apart[2]));
  }
  return largest;
}

/// The orthogonal factor of the polar decomposition. Signed permutations stay exact.
Matrix3 nearest_orthonormal(const Matrix3& m) {
  double rows[3][3];
  std::memcpy(rows, m.data(), sizeof(rows));
  vtkMath::Orthogonalize3x3(rows, rows);
  Matrix3 nearest;
  std::memcpy(nearest.data(), rows, sizeof(rows));
  return nearest;
}

bool is_orthonormal(const Matrix3& m) {
  constexpr double kRounding = 1e-4;  // as ITK
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t b = a; b < 3; ++b) {
      const double product = m[a] * m[b] + m[3 + a] * m[3 + b] + m[6 + a] * m[6 + b];
      if (std::abs(product - (a == b ? 1 : 0)) > kRounding) return false;
    }
  }
  return true;
}

Result<void> check_numbers(const NiftiHeader& header, const std::filesystem::path& path) {
  const auto axes = static_cast<std::size_t>(std::min<std::int64_t>(3, header.dim[0]));
  for (std::size_t n = 1; n <= axes; ++n) {
    const double mm = header.pixdim[n] * header.mm_per_unit().value_or(1);
    if (!(is_plausible(mm) && mm != 0))
      return bad_file(path, "has a spacing of {} mm along axis {}; it must be a positive number", mm, n);
  }
  const auto check = [&](const auto& numbers) -> Result<void> {
    const auto bad = std::ranges::find_if_not(numbers, is_plausible);
    if (bad == numbers.end()) return {};
    return bad_file(path, "has {} in its orientation (qform or sform), which cannot be", *bad);
  };
  SPLATLAS_RETURN_IF_ERROR(check(header.quaternion));
  SPLATLAS_RETURN_IF_ERROR(check(header.qform_offset));
  return check(header.sform);
}

/// The affine that counts, and notes on the choice.
Result<Affine12> choose_affine(const NiftiHeader& header, const std::filesystem::path& path, Notes& notes) {
  const Affine12 qform = affine_of_qform(header);
  const bool has_qform = header.qform_code > 0, has_sform = header.sform_code > 0;
  if (has_sform && !is_singular(header.sform)) {
    const double apart = has_qform ? largest_distance(header, header.sform, qform) : 0;
    const double smallest = std::min({spacing(header, 0), spacing(header, 1), spacing(header, 2)});
    constexpr double kNegligible = 0.1;  // voxels
    if (apart > kNegligible * smallest) {
      notes.add("sform-and-qform-differ",
                fmt::format("{} (the qform places voxels up to {:.3g} mm elsewhere)", path.string(),
                            apart * header.mm_per_unit().value_or(1)));
    }
    return header.sform;
  }
  if (has_sform && !has_qform)
    return bad_file(
        path, "has a singular orientation (its sform has no volume), and no qform; give it a valid sform");
  if (has_sform) notes.add("singular-sform", path.string());
  if (has_qform) return qform;
  notes.add("no-orientation", path.string());
  return affine_without_orientation(header);
}

std::string_view text_at(std::span<const std::byte> bytes, std::size_t offset, std::size_t length) {
  return {reinterpret_cast<const char*>(bytes.data()) + offset, length};
}

/// NIfTI-1 and Analyze: offsets in nifti1.h.
void read_short_header(const Fields& fields, NiftiHeader& header) {
  fields.get_all<std::int16_t>(40, header.dim);
  header.intent = fields.get<std::int16_t>(68);
  header.datatype = fields.get<std::int16_t>(70);
  header.bits_per_voxel = fields.get<std::int16_t>(72);
  fields.get_all<float>(76, header.pixdim);
  header.voxel_offset = double{fields.get<float>(108)};
  if (header.kind == NiftiHeader::Kind::kAnalyze) return;
  header.slope = double{fields.get<float>(112)};
  header.intercept = double{fields.get<float>(116)};
  header.units = fields.get<std::uint8_t>(123);
  header.qform_code = fields.get<std::int16_t>(252);
  header.sform_code = fields.get<std::int16_t>(254);
  fields.get_all<float>(256, header.quaternion);
  fields.get_all<float>(268, header.qform_offset);
  fields.get_all<float>(280, header.sform);
}

/// NIfTI-2: offsets in nifti2.h.
void read_long_header(const Fields& fields, NiftiHeader& header) {
  header.datatype = fields.get<std::int16_t>(12);
  header.bits_per_voxel = fields.get<std::int16_t>(14);
  fields.get_all<std::int64_t>(16, header.dim);
  fields.get_all<double>(104, header.pixdim);
  header.voxel_offset = static_cast<double>(fields.get<std::int64_t>(168));
  header.slope = fields.get<double>(176);
  header.intercept = fields.get<double>(184);
  header.qform_code = fields.get<std::int32_t>(344);
  header.sform_code = fields.get<std::int32_t>(348);
  fields.get_all<double>(352, header.quaternion);
  fields.get_all<double>(376, header.qform_offset);
  fields.get_all<double>(400, header.sform);
  header.units = fields.get<std::int32_t>(500);
  header.intent = fields.get<std::int32_t>(504);
}

}  // namespace

std::optional<double> NiftiHeader::mm_per_unit() const {
  constexpr std::array<double, 8> kFactors{0, 1e3, 1, 1e-3};  // unknown, metres, mm, micrometres
  const double mm = kFactors.at(static_cast<std::size_t>(units) % kFactors.size());
  return mm > 0 ? std::optional(mm) : std::nullopt;
}

Result<NiftiHeader> parse_nifti_header(std::span<const std::byte> bytes, const std::filesystem::path& path) {
  if (bytes.size() < NiftiHeader::kNifti1Bytes) return bad_file(path, "is not a NIfTI file (too short)");
  NiftiHeader header;
  const auto size_is = [&](std::int32_t size) {
    for (const bool is_swapped : {false, true}) {
      if (Fields(bytes, is_swapped).get<std::int32_t>(0) != size) continue;
      header.is_swapped = is_swapped;
      return true;
    }
    return false;
  };
  const std::string_view magic = text_at(bytes, 344, 4), magic2 = text_at(bytes, 4, 4);
  if (size_is(NiftiHeader::kMaxBytes) && bytes.size() >= NiftiHeader::kMaxBytes &&
      (magic2 == std::string_view("n+2\0", 4) || magic2 == std::string_view("ni2\0", 4))) {
    header.kind = NiftiHeader::Kind::kNifti2;
    header.is_pair = magic2[1] == 'i';
    read_long_header(Fields(bytes, header.is_swapped), header);
  } else if (size_is(NiftiHeader::kNifti1Bytes)) {
    const bool is_nifti = magic == std::string_view("n+1\0", 4) || magic == std::string_view("ni1\0", 4);
    header.kind = is_nifti ? NiftiHeader::Kind::kNifti1 : NiftiHeader::Kind::kAnalyze;
    header.is_pair = !is_nifti || magic[1] == 'i';
    read_short_header(Fields(bytes, header.is_swapped), header);
  } else {
    return bad_file(path, "is neither a NIfTI nor an Analyze file (its header has no such length)");
  }
  constexpr std::int64_t kFirstConnectivity = 3000, kLastConnectivity = 3099;
  if (header.intent >= kFirstConnectivity && header.intent <= kLastConnectivity) {
    return bad_file(path, "is a CIFTI file (intent {}) of values on surfaces, and holds no volume",
                    header.intent);
  }
  if (header.dim[0] < 2 || header.dim[0] > 7)
    return bad_file(path, "has {} dimensions; a volume has 2 or 3", header.dim[0]);
  return header;
}

Grid grid_of_ras_affine(const Index3& size, const Affine12& affine) {
  Grid grid;
  grid.size = size;
  Matrix3 direction = columns_of(affine);
  for (std::size_t a = 0; a < 3; ++a) {
    grid.spacing_mm[a] = length_of_column(direction, a);
    for (std::size_t row = 0; row < 3; ++row)
      direction[3 * row + a] *= (row < 2 ? -1 : 1) / grid.spacing_mm[a];
  }
  if (is_orthonormal(direction)) direction = nearest_orthonormal(direction);
  for (std::size_t n = 0; n < 9; ++n)
    grid.direction_lps[n] = direction[n] + 0.0;  // -0 becomes 0: equal grids print alike
  for (std::size_t row = 0; row < 3; ++row)
    grid.origin_lps_mm[row] = (row < 2 ? -1 : 1) * affine[4 * row + 3] + 0.0;
  return grid;
}

Result<Grid> nifti_grid(const NiftiHeader& header, const std::filesystem::path& path, Notes& notes) {
  SPLATLAS_RETURN_IF_ERROR(check_numbers(header, path));
  SPLATLAS_ASSIGN_OR_RETURN(Affine12 affine, choose_affine(header, path, notes));
  const double mm = header.mm_per_unit().value_or(1);
  if (mm < 1 || mm > 1) notes.add("units", path.string());
  for (double& number : affine) number *= mm;
  Index3 size;
  for (std::size_t a = 0; a < 3; ++a)
    size[a] = static_cast<std::int64_t>(a) < header.dim[0] ? header.dim[a + 1] : 1;
  Grid grid = grid_of_ras_affine(size, affine);
  constexpr double kRounding = 1e-5, kLeast = 0.005, kMost = 100;  // the latter in mm
  for (std::size_t a = 0; a < 3; ++a) {
    // The sform repeats the spacing, rounded.
    const double stated = spacing(header, a) * mm;
    if (std::abs(grid.spacing_mm[a] - stated) <= kRounding * stated) grid.spacing_mm[a] = stated;
  }
  const auto [least, most] = std::ranges::minmax(grid.spacing_mm);
  if (!header.mm_per_unit() && (least < kLeast || most > kMost)) notes.add("unknown-unit", path.string());
  SPLATLAS_RETURN_IF_ERROR(validate(grid, path.string()));
  return grid;
}

}  // namespace splatlas

#include "preprocess/export/write_image.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <functional>
#include <initializer_list>
#include <limits>
#include <memory>
#include <new>
#include <optional>
#include <span>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nifti1_io.h>
#include <zlib.h>

#include "format/result_macros.h"
#include "format/tasks/task_control.h"
#include "format/text/ascii_text.h"
#include "preprocess/import/images/nifti/nifti_header.h"
#include "preprocess/import/images/pixels/check_image_file.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

using Bytes = std::span<const std::byte>;
/// Takes the bytes of a file, piece by piece. Not called before the header is known to hold the image.
using Sink = std::function<Result<void>(Bytes)>;

/// Compression of ITK's writers, and of masks.
constexpr int kNiftiLevel = 6, kTextHeaderLevel = 2, kMaskLevel = 1;

/// kFailed for a geometry that import_image() refuses.
Result<void> check_readable(const Grid& grid, const fs::path& path) {
  const auto refuse = [&](double mm) {
    return bad_file(path, "the volume's geometry has {:.4g} mm; files can hold at most 1e9 mm", mm);
  };
  for (std::size_t a = 0; a < 3; ++a) {
    if (std::abs(grid.origin_lps_mm[a]) > kMaxPlausible) return refuse(grid.origin_lps_mm[a]);
    for (std::size_t row = 0; row < 3; ++row) {
      const double mm = grid.spacing_mm[a] * grid.direction_lps[3 * row + a];
      if (std::abs(mm) > kMaxPlausible) return refuse(mm);
    }
  }
  return {};
}

Bytes bytes_of_text(const std::string& text) {
  return std::as_bytes(std::span(text));
}

/// Compresses the parts into one zlib stream, or a gzip file, and hands over its pieces in order.
Result<void> deflate_parts(std::initializer_list<Bytes> parts, bool gzip, int level, const fs::path& path,
                           const Sink& sink) {
  constexpr int kWindowBits = 15, kGzip = 16, kMemoryLevel = 8;
  constexpr std::size_t kMaxInput = std::size_t{1} << 30;  // zlib's counts have 32 bits
  z_stream stream{};
  if (deflateInit2(&stream, level, Z_DEFLATED, kWindowBits + (gzip ? kGzip : 0), kMemoryLevel,
                   Z_DEFAULT_STRATEGY) != Z_OK)
    return fail(ErrorCode::kLimit, "{}: cannot be written: out of memory", path.string());
  const std::unique_ptr<z_stream, int (*)(z_stream*)> end(&stream, deflateEnd);
  std::vector<std::byte> buffer(1 << 18);
  const auto pump = [&](Bytes bytes, int flush) -> Result<void> {
    stream.next_in =
        const_cast<Bytef*>(reinterpret_cast<const Bytef*>(bytes.data()));  // zlib does not change it
    stream.avail_in = static_cast<unsigned>(bytes.size());
    do {
      check_task();
      stream.next_out = reinterpret_cast<Bytef*>(buffer.data());
      stream.avail_out = static_cast<unsigned>(buffer.size());
      deflate(&stream, flush);  // cannot fail: the state is valid and there is room
      const std::size_t made = buffer.size() - stream.avail_out;
      if (made > 0) SPLATLAS_RETURN_IF_ERROR(sink(std::span(buffer).first(made)));
    } while (stream.avail_out == 0);
    return {};
  };
  for (Bytes part : parts) {
    for (; !part.empty(); part = part.subspan(std::min(part.size(), kMaxInput)))
      SPLATLAS_RETURN_IF_ERROR(pump(part.first(std::min(part.size(), kMaxInput)), Z_NO_FLUSH));
  }
  return pump({}, Z_FINISH);
}

/// The axes and the origin, in RAS.
mat44 axes_ras(const Grid& grid) {
  mat44 axes{};
  for (std::size_t row = 0; row < 3; ++row) {
    const float sign = row < 2 ? -1.f : 1.f;
    for (std::size_t a = 0; a < 3; ++a)
      axes.m[row][a] = sign * static_cast<float>(grid.direction_lps[3 * row + a]);
    axes.m[row][3] = sign * static_cast<float>(grid.origin_lps_mm[row]);
  }
  return axes;
}

/// Replaces axes by the nearest orthonormal ones. False for sheared ones, which stay.
bool make_orthonormal(mat44& axes) {
  const auto& m = axes.m;
  const mat44 rows = nifti_make_orthog_mat44(m[0][0], m[1][0], m[2][0], m[0][1], m[1][1], m[2][1], m[0][2],
                                             m[1][2], m[2][2]);
  constexpr float kMaxShear = 1e-4f;
  mat44 nearest = axes;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t a = 0; a < 3; ++a) {
      nearest.m[row][a] = rows.m[a][row];
      if (!(std::abs(nearest.m[row][a] - m[row][a]) <= kMaxShear)) return false;
    }
  }
  axes = nearest;
  return true;
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
  h.datatype = kNiftiTypes[static_cast<std::size_t>(type)];
  h.bitpix = static_cast<std::int16_t>(8 * bytes_of(type));
  h.vox_offset = sizeof(h) + 4;  // behind the empty list of extensions
  h.scl_slope = 1;
  h.xyzt_units = NIFTI_UNITS_MM;
  std::copy_n("n+1", 4, h.magic);

  mat44 axes = axes_ras(grid);
  h.sform_code = NIFTI_XFORM_SCANNER_ANAT;
  h.qform_code = make_orthonormal(axes) ? NIFTI_XFORM_SCANNER_ANAT : NIFTI_XFORM_UNKNOWN;
  nifti_mat44_to_quatern(axes, &h.quatern_b, &h.quatern_c, &h.quatern_d, &h.qoffset_x, &h.qoffset_y,
                         &h.qoffset_z, nullptr, nullptr, nullptr, &h.pixdim[0]);
  const std::array<float*, 3> sform{h.srow_x, h.srow_y, h.srow_z};
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t a = 0; a < 3; ++a) axes.m[row][a] *= static_cast<float>(grid.spacing_mm[a]);
    std::copy_n(axes.m[row], 4, sform[row]);
    std::for_each_n(sform[row], 4, make_plausible);
  }
  for (float* const number :
       {&h.quatern_b, &h.quatern_c, &h.quatern_d, &h.qoffset_x, &h.qoffset_y, &h.qoffset_z})
    make_plausible(*number);
  return h;
}

/// True if import_image() reads the grid from the header.
bool holds(const std::string& header, const Grid& grid, const fs::path& path) {
  const auto parsed = parse_nifti_header(std::as_bytes(std::span(header)), path);
  Notes notes;
  const Result<Grid> read = parsed ? nifti_grid(*parsed, path, notes) : tl::unexpected(parsed.error());
  return read && check_same_grid(grid, "", *read, "");
}

// Headers of NRRD and MetaImage files.

constexpr const char kNrrdHeader[] =
#include "preprocess/export/nrrd_header.txt"
    ;
constexpr const char kMetaImageHeader[] =
#include "preprocess/export/meta_image_header.txt"
    ;
static_assert(std::endian::native == std::endian::little, "voxels are written in the order of the machine");

// Names by the number of a VoxelType.
constexpr std::array kNrrdTypes{
    "", "unsigned char", "signed char", "unsigned short", "short", "unsigned int", "int", "float", "double"};
constexpr std::array kMetaTypes{"",         "MET_UCHAR", "MET_CHAR",  "MET_USHORT", "MET_SHORT",
                                "MET_UINT", "MET_INT",   "MET_FLOAT", "MET_DOUBLE"};

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

/// All ahead of the voxels of an NRRD file with encoding gzip. Numbers: shortest text of the exact doubles.
std::string nrrd_header(const Grid& grid, VoxelType type) {
  const auto direction = [&](std::size_t axis) {
    return fmt::format("({})", fmt::join(scaled_direction(grid, axis, grid.spacing_mm[axis]), ","));
  };
  return fmt::format(kNrrdHeader, kNrrdTypes[static_cast<std::size_t>(type)], fmt::join(grid.size, " "),
                     direction(0), direction(1), direction(2), fmt::join(plausible(grid.origin_lps_mm), ","));
}

/// The same of a MetaImage file with `compressed_bytes` bytes of compressed voxels.
std::string meta_image_header(const Grid& grid, VoxelType type, std::uint64_t compressed_bytes) {
  const auto direction = [&](std::size_t axis) {
    return fmt::format("{}", fmt::join(scaled_direction(grid, axis, 1), " "));
  };
  return fmt::format(kMetaImageHeader, compressed_bytes, direction(0), direction(1), direction(2),
                     fmt::join(plausible(grid.origin_lps_mm), " "), fmt::join(grid.spacing_mm, " "),
                     fmt::join(grid.size, " "), kMetaTypes[static_cast<std::size_t>(type)]);
}

Result<void> write_nifti(const Image& image, const fs::path& path, int level, const Sink& sink) {
  SPLATLAS_ASSIGN_OR_RETURN(const std::string header, nifti_header(image.grid, image.voxels.type, path));
  if (to_lower(path.extension().string()) == ".gz") {
    return deflate_parts({bytes_of_text(header), image.voxels.bytes}, true, level, path, sink);
  }
  SPLATLAS_RETURN_IF_ERROR(sink(bytes_of_text(header)));
  return sink(image.voxels.bytes);
}

/// The header holds the number of compressed bytes, so they are kept in memory.
Result<void> write_meta_image(const Image& image, const fs::path& path, const Sink& sink) {
  std::vector<std::vector<std::byte>> pieces;
  std::uint64_t bytes = 0;
  const auto keep = [&](Bytes piece) -> Result<void> {
    pieces.emplace_back(piece.begin(), piece.end());
    bytes += piece.size();
    return {};
  };
  SPLATLAS_RETURN_IF_ERROR(deflate_parts({image.voxels.bytes}, false, kTextHeaderLevel, path, keep));
  SPLATLAS_RETURN_IF_ERROR(sink(bytes_of_text(meta_image_header(image.grid, image.voxels.type, bytes))));
  for (const std::vector<std::byte>& piece : pieces) SPLATLAS_RETURN_IF_ERROR(sink(piece));
  return {};
}

/// Writes everything into a sink; NIfTI's compression has `level`.
Result<void> write_whole(const Image& image, const fs::path& path, int level, const Sink& sink) {
  SPLATLAS_ASSIGN_OR_RETURN(const ImageFormat format, writable_image_format(path));
  SPLATLAS_RETURN_IF_ERROR(check_readable(image.grid, path));
  try {
    switch (format) {
      case ImageFormat::kNifti: return write_nifti(image, path, level, sink);
      case ImageFormat::kNrrd:
        SPLATLAS_RETURN_IF_ERROR(sink(bytes_of_text(nrrd_header(image.grid, image.voxels.type))));
        return deflate_parts({image.voxels.bytes}, true, kTextHeaderLevel, path, sink);
      case ImageFormat::kMetaImage: break;
    }
    return write_meta_image(image, path, sink);
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::kLimit, "{}: cannot be written: out of memory", path.string());
  }
}

}  // namespace

Result<ImageFormat> writable_image_format(const fs::path& path) {
  const std::string name = to_lower(path.filename().string());
  if (name.ends_with(".nii") || name.ends_with(".nii.gz")) return ImageFormat::kNifti;
  if (name.ends_with(".nrrd")) return ImageFormat::kNrrd;
  if (name.ends_with(".mha")) return ImageFormat::kMetaImage;
  const bool is_header = name.ends_with(".nhdr") || name.ends_with(".mhd");
  return fail(ErrorCode::kUsage, "{}: {}", path.string(),
              is_header ? fmt::format("would be two files; write {}", name.ends_with("r") ? ".nrrd" : ".mha")
                        : "is of no known type; volumes are written as .nii, .nii.gz, .nrrd or .mha");
}

Result<OutputFile> write_image(const Image& image, const fs::path& path) {
  std::optional<OutputFile> file;
  SPLATLAS_RETURN_IF_ERROR(write_whole(image, path, kNiftiLevel, [&](Bytes piece) -> Result<void> {
    if (!file) {
      SPLATLAS_ASSIGN_OR_RETURN(file, OutputFile::create(path));
    }
    return file->write(piece);
  }));
  return std::move(*file);
}

Result<std::vector<std::byte>> encode_image(const Image& image, const fs::path& path) {
  std::vector<std::byte> file;
  SPLATLAS_RETURN_IF_ERROR(write_whole(image, path, kMaskLevel, [&](Bytes piece) -> Result<void> {
    file.insert(file.end(), piece.begin(), piece.end());
    return {};
  }));
  return file;
}

Result<std::string> nifti_header(const Grid& grid, VoxelType type, const fs::path& path) {
  constexpr std::int64_t kMaxSize = std::numeric_limits<std::int16_t>::max();
  if (std::ranges::max(grid.size) > kMaxSize) {
    return bad_file(path, "this format cannot hold {} voxels: at most {} along an axis; write .nrrd",
                    fmt::join(grid.size, " x "), kMaxSize);
  }
  const nifti_1_header header = make_header(grid, type);
  std::string bytes(sizeof(header) + 4, '\0');
  std::memcpy(bytes.data(), &header, sizeof(header));
  if (!holds(bytes, grid, path))
    return bad_file(path, "this format cannot hold the volume's geometry; write .nrrd");
  return bytes;
}

}  // namespace splatlas

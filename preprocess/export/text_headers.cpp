// Headers of NRRD and MetaImage files.
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "preprocess/export/image_header.h"

namespace splatlas {
namespace {

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

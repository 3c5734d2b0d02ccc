// Headers of volume files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "format/content/grid.h"
#include "format/content/voxel_type.h"
#include "format/result.h"

namespace splatlas {

/// Everything ahead of the voxels of an NRRD file with encoding gzip. Numbers are the shortest text of the
/// exact doubles. `type` is not kNone; voxels are little-endian.
[[nodiscard]] std::string nrrd_header(const Grid& grid, VoxelType type);

/// The same of a MetaImage file with `compressed_bytes` bytes of compressed voxels.
[[nodiscard]] std::string meta_image_header(const Grid& grid, VoxelType type, std::uint64_t compressed_bytes);

/// The same of a NIfTI-1 file, 352 bytes, with ITK's conventions: qform and sform in RAS, both with code 1,
/// in single precision and with orthonormal axes. Sheared axes have an sform alone. kFailed, with `path`, if
/// import_image() would read another grid from them (check_same_grid()), and for more than 32767 voxels along
/// an axis.
[[nodiscard]] Result<std::string> nifti_header(const Grid& grid, VoxelType type,
                                               const std::filesystem::path& path);

}  // namespace splatlas

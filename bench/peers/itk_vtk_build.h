// ITK and VTK as a peer of the build: loading and marching cubes alone.
#pragma once

#include <cstdint>
#include <filesystem>

#include "format/result.h"

namespace splatlas {

/// Files in NIfTI, on one grid.
struct ItkVtkSources {
  std::filesystem::path volume, labels, mask;
};

/// Loads the files with ITK and extracts a surface of each label (vtkDiscreteMarchingCubes, all labels in one
/// pass), of the mask at 0.5, and of the volume at `threshold` (vtkMarchingCubes). Nothing is stored. One
/// thread. Returns the number of triangles. ErrorCode::kFailed: ITK cannot read a file.
Result<std::uint64_t> load_and_march(const ItkVtkSources& sources, int labels, double threshold);

}  // namespace splatlas

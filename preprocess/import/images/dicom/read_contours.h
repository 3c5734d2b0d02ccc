// Structures of DICOM contours (RTSTRUCT).
#pragma once

#include <filesystem>
#include <optional>

#include "format/result.h"
#include "preprocess/import/images/pixels/source_image.h"

namespace splatlas {

/// Fills the closed contours of each structure: voxels whose centres are within, by the even-odd rule, so
/// that a contour within another is a hole. A slice takes the nearest plane of contours, and none where
/// planes are missing. Structures have the file's names and colours, and may overlap. Warnings tell
/// of points and open lines, which enclose nothing, and of structures that `grid` cuts off. kFailed without a
/// grid, for damaged files, and for contours across slices. Cost: memory for the layers and the largest
/// structure. One thread at a time.
[[nodiscard]] Result<SourceImage> read_contours(const std::filesystem::path& path,
                                                const std::optional<Grid>& grid);

}  // namespace splatlas

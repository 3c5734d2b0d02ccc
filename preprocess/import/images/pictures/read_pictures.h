// Reader of stacks of pictures: TIFF, and PNG by ITK.
#pragma once

#include <filesystem>

#include "preprocess/import/images/pixels/source_image.h"

namespace splatlas {

/// True for .tif, .tiff and .png.
[[nodiscard]] bool is_picture(const std::filesystem::path& path);

/// Reads one picture, a TIFF file of several pages, or all pictures of a folder, one slice each. Files are in
/// the order of the numbers in their names: slice_2 stands before slice_10. Pictures hold no positions:
/// kUsage without `options.spacing_mm`, but in a BrainGlobe folder, which has its own (brainglobe_folder.h).
/// A warning tells that x runs to the left, y to the back, and slices upwards. kFailed for colours, palettes,
/// and pictures of several sizes or types.
[[nodiscard]] Result<SourceImage> read_pictures(const std::filesystem::path& file_or_folder,
                                                const ImageOptions& options);

}  // namespace splatlas

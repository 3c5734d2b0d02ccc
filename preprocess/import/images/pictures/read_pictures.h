// Reader of stacks of pictures: TIFF, and PNG by ITK.
#pragma once

#include <filesystem>
#include <optional>

#include "format/content/grid.h"
#include "format/result.h"
#include "preprocess/import/images/pixels/source_image.h"

namespace splatlas {

/// True for .tif, .tiff and .png.
[[nodiscard]] bool is_picture(const std::filesystem::path& path);

/// Reads one picture, a TIFF file of several pages, or all pictures of a folder, one slice each. Files are in
/// the order of the numbers in their names: slice_2 stands before slice_10. Pictures hold no positions:
/// kUsage without `options.spacing_mm`, but in a BrainGlobe folder, which has its own.
/// A warning tells that x runs to the left, y to the back, and slices upwards. kFailed for colours, palettes,
/// and pictures of several sizes or types.
[[nodiscard]] Result<SourceImage> read_pictures(const std::filesystem::path& file_or_folder,
                                                const ImageOptions& options);

/// True for a folder with metadata.json, annotation.tiff and structures.json (BrainGlobe, version 1).
[[nodiscard]] bool is_brainglobe_folder(const std::filesystem::path& path);

/// Spacing and direction of the axes of a stack of pictures: columns, rows, pages.
struct PictureFrame {
  Vec3 spacing_mm{};
  Matrix3 direction_lps{};
};

/// The frame that metadata.json tells for the pictures beside it: resolution in micrometres and orientation,
/// the corner where the axes begin ("asr": pages run to the back, rows downwards, columns to the left).
/// Nothing if the file's folder is no BrainGlobe folder. kFailed for metadata that cannot be.
[[nodiscard]] Result<std::optional<PictureFrame>> brainglobe_frame(const std::filesystem::path& picture);

}  // namespace splatlas

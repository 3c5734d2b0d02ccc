// Folders of BrainGlobe atlases.
#pragma once

#include <filesystem>
#include <optional>

#include "format/content/grid.h"

namespace splatlas {

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

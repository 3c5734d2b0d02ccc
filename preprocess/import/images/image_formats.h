// Registry of image formats.
#pragma once

#include <filesystem>
#include <string>

#include "preprocess/import/images/pixels/source_image.h"

namespace splatlas {

/// A format of volumes and label maps. A new one is a reader and a line in image_formats.cpp.
struct ImageFormatEntry {
  const char* name;  ///< for messages: "NIfTI"
  bool (*recognises)(const std::filesystem::path& file_or_folder);
  Result<SourceImage> (*read)(const std::filesystem::path& file_or_folder, const ImageOptions& options);
};

/// The format of a file or a folder; null for others.
[[nodiscard]] const ImageFormatEntry* find_image_format(const std::filesystem::path& file_or_folder);

/// Reads a file or a folder in this process. kFailed for what no format recognises; the message leads on.
[[nodiscard]] Result<SourceImage> read_image_here(const std::filesystem::path& file_or_folder,
                                                  const ImageOptions& options);
/// The same in a child, so that no file brings this process down (run_isolated.h).
[[nodiscard]] Result<SourceImage> read_image(const std::filesystem::path& file_or_folder,
                                             const ImageOptions& options);

}  // namespace splatlas

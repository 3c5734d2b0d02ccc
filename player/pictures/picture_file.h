// Pictures to files.
#pragma once

#include <filesystem>
#include <future>
#include <optional>

#include "format/result.h"
#include "player/picture.h"

namespace splatlas {

/// Writes .png, .jpg, .tif (8-bit sRGB) and .exr (float, linear, premultiplied) through OpenImageIO.
/// OpenImageIO brings some two hundred libraries with it, so it stands in a module of its own that is loaded
/// on a thread while the picture is being rendered, and not at all by programs that write none.
class PictureWriter {
 public:
  /// Starts to load the module.
  PictureWriter();

  /// Whether `path` ends in one of the known endings; kUsage, naming them, if not.
  [[nodiscard]] static Result<void> check_ending(const std::filesystem::path& path);

  /// Over `background`, or with alpha where there is none (JPEG then is over black). EXR always keeps alpha
  /// and ignores the background. Written to a temporary file beside `path` and renamed: never half a picture.
  [[nodiscard]] Result<void> write(const Picture& picture, const std::filesystem::path& path,
                                   std::optional<Rgb> background);

 private:
  std::future<Result<void*>> module_;  // the module's write function
  void* function_ = nullptr;
};

}  // namespace splatlas

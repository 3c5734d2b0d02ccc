// Pictures to files.
#pragma once

#include <filesystem>
#include <future>
#include <optional>
#include <string>

#include "format/result.h"
#include "player/picture.h"

namespace splatlas {

/// Writes one file: .png, .jpg, .tif (8-bit sRGB) or .exr (float, linear, premultiplied). PNG goes through
/// libpng. The others go through OpenImageIO, which brings some 260 libraries with it: loading them takes 0.2
/// s, longer than most pictures do, so it stands in a module of its own that is loaded on a thread while the
/// picture is being rendered, and not at all where nobody asks for it.
class PictureWriter {
 public:
  /// Starts to load the module where `path` needs it.
  explicit PictureWriter(std::filesystem::path path);

  /// Whether `path` ends in one of the known endings; kUsage, naming them, if not.
  [[nodiscard]] static Result<void> check_ending(const std::filesystem::path& path);

  /// Once. Over `background`, or with alpha where there is none (JPEG then is over black). EXR always keeps
  /// alpha and ignores the background. Written to a temporary file beside the path and renamed: never half a
  /// picture.
  [[nodiscard]] Result<void> write(const Picture& picture, std::optional<Rgb> background);

 private:
  std::filesystem::path path_;
  std::string ending_;
  std::future<Result<void*>> module_;  // the module's write function
};

}  // namespace splatlas

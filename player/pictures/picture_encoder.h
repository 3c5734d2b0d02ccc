// Encoder of picture files.
#pragma once

#include <cstddef>
#include <filesystem>
#include <future>
#include <optional>
#include <string>
#include <vector>

#include "format/result.h"
#include "player/picture.h"

namespace splatlas {

/// Encodes one picture as .png, .jpg, .tif (8-bit sRGB) or .exr (float, linear, premultiplied). libpng writes
/// PNG, OpenImageIO the others. OpenImageIO depends on about 260 libraries, which take 0.2 s to load, longer
/// than rendering most pictures. It is in a module of its own, loaded on demand and concurrently with
/// rendering.
class PictureEncoder {
 public:
  /// Prepares for a file of this name, and begins to load the module if needed.
  explicit PictureEncoder(std::filesystem::path path);

  /// True for formats without transparency, by the file's ending.
  [[nodiscard]] static bool is_opaque(const std::filesystem::path& path);
  /// kUsage, with the supported extensions, unless `path` has one of them.
  [[nodiscard]] static Result<void> check_ending(const std::filesystem::path& path);
  /// kUsage, with a remedy, if the format of `path` does not support pictures of this size. The extension
  /// must be supported.
  [[nodiscard]] static Result<void> check_size(const std::filesystem::path& path, const PictureSize& size,
                                               std::optional<Rgb> background);

  /// The bytes of the file; to call once. Composites over `background`, or keeps alpha without one (JPEG is
  /// then over black). EXR always keeps alpha and ignores the background. kFailed for errors of the module
  /// and its libraries. Memory: at most picture_bytes() in addition to the picture.
  [[nodiscard]] Result<std::vector<std::byte>> encode(const Picture& picture, std::optional<Rgb> background);

 private:
  [[nodiscard]] Result<std::vector<std::byte>> encode_pixels(const Picture& picture,
                                                             std::optional<Rgb> background);

  std::filesystem::path path_;
  std::string ending_;
  std::future<Result<void*>> module_;  // the module's encode function
};

}  // namespace splatlas

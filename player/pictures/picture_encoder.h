// Pictures to the bytes of picture files.
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

/// Encodes one picture: .png, .jpg, .tif (8-bit sRGB) or .exr (float, linear, premultiplied). PNG goes
/// through libpng. The others go through OpenImageIO, which brings some 260 libraries with it: loading them
/// takes 0.2 s, longer than most pictures do, so it stands in a module of its own that is loaded on a thread
/// while the picture is being rendered, and not at all where nobody asks for it.
class PictureEncoder {
 public:
  /// For a file of this name. Starts to load the module where it is needed.
  explicit PictureEncoder(std::filesystem::path path);

  /// Whether `path` ends in one of the known endings; kUsage, naming them, if not.
  [[nodiscard]] static Result<void> check_ending(const std::filesystem::path& path);
  /// Whether the format that `path` ends in can hold so many pixels; kUsage, saying what to do, if not. The
  /// ending is a known one.
  [[nodiscard]] static Result<void> check_size(const std::filesystem::path& path, const PictureSize& size,
                                               std::optional<Rgb> background);

  /// The whole file. Once. Over `background`, or with alpha where there is none (JPEG then is over black).
  /// EXR always keeps alpha and ignores the background. Writes nothing: what can go wrong is the module and
  /// the libraries. Takes at most picture_bytes() beside the picture.
  [[nodiscard]] Result<std::vector<std::byte>> encode(const Picture& picture, std::optional<Rgb> background);

 private:
  [[nodiscard]] Result<std::vector<std::byte>> encode_pixels(const Picture& picture,
                                                             std::optional<Rgb> background);

  std::filesystem::path path_;
  std::string ending_;
  std::future<Result<void*>> module_;  // the module's encode function
};

}  // namespace splatlas

// Encoder of picture files.
#pragma once

#include <cstddef>
#include <filesystem>
#include <future>
#include <optional>
#include <string>
#include <vector>

#include "format/result.h"
#include "player/files/draw_annotations.h"
#include "player/files/picture_module.h"
#include "player/page/annotation.h"
#include "player/picture.h"

namespace splatlas {

[[nodiscard]] std::string lower_ending(const std::filesystem::path& path);
/// Calls a module's EncodePixels. kFailed with the library's message.
[[nodiscard]] Result<std::vector<std::byte>> encode_pixels(void* function, const PixelsToEncode& pixels);

/// Annotations of a file, with everything to draw them.
struct FileAnnotations {
  const AnnotationLayer* layer = nullptr;    ///< none: without annotations
  TextDrawer* drawer = nullptr;              ///< ready, if there is a layer
  std::string title = {};                    ///< of the document, .pdf only
  std::optional<double> dpi = std::nullopt;  ///< pixels per inch in print; stored in all files but .exr
  PageTexts texts = {};                      ///< this and the next: those of PdfPage, .pdf only
  bool is_last = true;
};

/// Encodes one picture as .png, .jpg, .tif (8-bit sRGB), .exr (float, linear, premultiplied), or as .svg or
/// .pdf, with annotations as vectors. libpng writes PNG, OpenImageIO other pixels, Cairo PDF. OpenImageIO
/// depends on about 260 libraries, which take 0.2 s to load, longer than rendering most pictures. It is in a
/// module of its own, loaded on demand and concurrently with rendering; so are Pango and Cairo.
class PictureEncoder {
 public:
  /// Prepares for a file of this name, and begins to load the module if needed.
  explicit PictureEncoder(std::filesystem::path path);

  /// True for formats without transparency, by the file's ending.
  [[nodiscard]] static bool is_opaque(const std::filesystem::path& path);
  /// True for .exr, which ignores backgrounds.
  [[nodiscard]] static bool is_linear(const std::filesystem::path& path);
  /// kUsage, with the supported extensions, unless `path` has one of them.
  [[nodiscard]] static Result<void> check_ending(const std::filesystem::path& path);
  /// kUsage, with a remedy, if the format of `path`, a supported one, has no pictures of this size.
  [[nodiscard]] static Result<void> check_size(const std::filesystem::path& path, const PictureSize& size,
                                               std::optional<Rgb> background);

  /// The bytes of the file; to call once, except for .png. Composites over `background`, or keeps alpha
  /// without one (JPEG is then over black). EXR always keeps alpha and ignores the background. Draws the
  /// annotations into the picture, or writes them as vectors into documents. kFailed for errors of modules
  /// and their libraries. Memory: picture_bytes() beside the picture; documents twice that.
  [[nodiscard]] Result<std::vector<std::byte>> encode(Picture& picture, std::optional<Rgb> background,
                                                      const FileAnnotations& annotations);
  /// The same, but draws no annotations into pixels, and errors do not name the file.
  [[nodiscard]] Result<std::vector<std::byte>> encode_file(const Picture& picture,
                                                           std::optional<Rgb> background,
                                                           const FileAnnotations& annotations = {});

 private:
  std::filesystem::path path_;
  std::string ending_;
  std::future<Result<void*>> module_;  // the module's encode function
};

}  // namespace splatlas

#include "player/pictures/picture_file.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string>

#include <dlfcn.h>
#include <fmt/format.h>
#include <png.h>
#include <unistd.h>

#include "player/pictures/picture_module.h"

namespace splatlas {
namespace {

/// The ending in lower case, one spelling per format; empty when it is not known.
std::string known_ending(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  if (ending == ".jpeg") ending = ".jpg";
  if (ending == ".tiff") ending = ".tif";
  for (const char* known : {".png", ".jpg", ".tif", ".exr"}) {
    if (ending == known) return ending;
  }
  return {};
}

Result<void*> load_module() {
  void* module = dlopen(kPictureModule, RTLD_LAZY | RTLD_LOCAL);
  if (module == nullptr) {
    const char* reason = dlerror();
    return fail(ErrorCode::kFailed, fmt::format("cannot load {} (OpenImageIO): {}", kPictureModule,
                                                reason ? reason : "unknown reason"));
  }
  void* function = dlsym(module, kWritePixelsName);
  if (function == nullptr) {
    return fail(ErrorCode::kFailed,
                fmt::format("{} has no {}: it is of another version", kPictureModule, kWritePixelsName));
  }
  return function;
}

/// Pixels as a file needs them.
struct Pixels {
  PictureSize size;
  int channels = 4;
  bool is_float = false;
  std::vector<std::uint8_t> bytes;  ///< of the 8-bit formats
  const void* data = nullptr;
};

Pixels pixels_for(const std::string& ending, const Picture& picture, std::optional<Rgb> background) {
  if (ending == ".exr") return {picture.size, 4, true, {}, picture.rgba.data()};
  if (!background && ending == ".jpg") background = Rgb{0, 0, 0};
  Pixels pixels{picture.size, background ? 3 : 4, false, {}, nullptr};
  pixels.bytes = background ? to_srgb8(picture, *background) : to_srgba8(picture);
  pixels.data = pixels.bytes.data();
  return pixels;
}

/// An empty text, or what went wrong.
std::string write_png(const std::filesystem::path& path, const Pixels& pixels) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(pixels.size.width);
  image.height = static_cast<png_uint_32>(pixels.size.height);
  image.format = pixels.channels == 3 ? PNG_FORMAT_RGB : PNG_FORMAT_RGBA;
  if (png_image_write_to_file(&image, path.c_str(), 0, pixels.data, 0, nullptr) != 0) return {};
  return image.message;
}

std::string write_through_module(void* function, const std::filesystem::path& path, const std::string& ending,
                                 const Pixels& pixels) {
  std::array<char, 512> error{};
  const auto write_pixels = reinterpret_cast<WritePixels>(function);
  write_pixels(path.c_str(), ending.c_str(), pixels.size.width, pixels.size.height, pixels.channels,
               pixels.is_float ? 1 : 0, pixels.data, error.data(), error.size());
  return error.data();
}

/// A file beside its target, removed unless it is renamed to it.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::filesystem::path& target, const std::string& ending)
      : target_(target),
        path_(target.parent_path() / fmt::format(".{}.{}.part{}", target.stem().string(), getpid(), ending)) {
  }
  ~TemporaryFile() {
    std::error_code ignored;
    if (!renamed_) std::filesystem::remove(path_, ignored);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] Result<void> rename() {
    std::error_code failure;
    std::filesystem::rename(path_, target_, failure);
    if (failure) {
      return fail(ErrorCode::kFailed,
                  fmt::format("{}: cannot be written: {}", target_.string(), failure.message()));
    }
    renamed_ = true;
    return {};
  }

 private:
  std::filesystem::path target_, path_;
  bool renamed_ = false;
};

}  // namespace

PictureWriter::PictureWriter(std::filesystem::path path)
    : path_(std::move(path)), ending_(known_ending(path_)) {
  if (!ending_.empty() && ending_ != ".png") module_ = std::async(std::launch::async, load_module);
}

Result<void> PictureWriter::check_ending(const std::filesystem::path& path) {
  if (!known_ending(path).empty()) return {};
  return fail(ErrorCode::kUsage, fmt::format("{}: unknown picture ending '{}'; use .png, .jpg, .tif or .exr",
                                             path.string(), path.extension().string()));
}

Result<void> PictureWriter::write(const Picture& picture, std::optional<Rgb> background) {
  SPLATLAS_RETURN_IF_ERROR(check_ending(path_));
  const Pixels pixels = pixels_for(ending_, picture, background);
  TemporaryFile temporary(path_, ending_);
  std::string error;
  if (ending_ == ".png") {
    error = write_png(temporary.path(), pixels);
  } else {
    SPLATLAS_ASSIGN_OR_RETURN(void* const function, module_.get());
    error = write_through_module(function, temporary.path(), ending_, pixels);
  }
  if (!error.empty()) {
    return fail(ErrorCode::kFailed, fmt::format("{}: cannot be written: {}", path_.string(), error));
  }
  return temporary.rename();
}

}  // namespace splatlas

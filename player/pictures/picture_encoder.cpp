#include "player/pictures/picture_encoder.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string>

#include <dlfcn.h>
#include <fmt/format.h>
#include <png.h>

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
  void* function = dlsym(module, kEncodePixelsName);
  if (function == nullptr) {
    return fail(ErrorCode::kFailed,
                fmt::format("{} has no {}: it is of another version", kPictureModule, kEncodePixelsName));
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

using Bytes = std::vector<std::byte>;

tl::expected<Bytes, std::string> encode_png(const Pixels& pixels) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(pixels.size.width);
  image.height = static_cast<png_uint_32>(pixels.size.height);
  image.format = pixels.channels == 3 ? PNG_FORMAT_RGB : PNG_FORMAT_RGBA;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);  // a little more than the pixels
  Bytes bytes(size);
  if (png_image_write_to_memory(&image, bytes.data(), &size, 0, pixels.data, 0, nullptr) == 0) {
    return tl::unexpected<std::string>(image.message);
  }
  bytes.resize(size);
  return bytes;
}

tl::expected<Bytes, std::string> encode_through_module(void* function, const std::string& ending,
                                                       const Pixels& pixels) {
  const PixelsToEncode to_encode{ending.c_str(),  pixels.size.width,       pixels.size.height,
                                 pixels.channels, pixels.is_float ? 1 : 0, pixels.data};
  Bytes bytes;
  const auto take = [](void* context, const void* first, std::size_t size) {
    const auto* const begin = static_cast<const std::byte*>(first);
    static_cast<Bytes*>(context)->assign(begin, begin + size);
  };
  std::array<char, 512> error{};
  const auto encode_pixels = reinterpret_cast<EncodePixels>(function);
  if (encode_pixels(&to_encode, take, &bytes, error.data(), error.size()) != 0) {
    return tl::unexpected<std::string>(error.data());
  }
  return bytes;
}

}  // namespace

PictureEncoder::PictureEncoder(std::filesystem::path path)
    : path_(std::move(path)), ending_(known_ending(path_)) {
  if (!ending_.empty() && ending_ != ".png") module_ = std::async(std::launch::async, load_module);
}

Result<void> PictureEncoder::check_ending(const std::filesystem::path& path) {
  if (!known_ending(path).empty()) return {};
  return fail(ErrorCode::kUsage, fmt::format("{}: unknown picture ending '{}'; use .png, .jpg, .tif or .exr",
                                             path.string(), path.extension().string()));
}

Result<std::vector<std::byte>> PictureEncoder::encode(const Picture& picture, std::optional<Rgb> background) {
  SPLATLAS_RETURN_IF_ERROR(check_ending(path_));
  void* function = nullptr;
  if (module_.valid()) {
    SPLATLAS_ASSIGN_OR_RETURN(function, module_.get());
  }
  const Pixels pixels = pixels_for(ending_, picture, background);
  auto bytes = function == nullptr ? encode_png(pixels) : encode_through_module(function, ending_, pixels);
  if (bytes) return *std::move(bytes);
  return fail(ErrorCode::kFailed, fmt::format("{}: cannot be encoded: {}", path_.string(), bytes.error()));
}

}  // namespace splatlas

#include "player/pictures/picture_encoder.h"

#include <algorithm>
#include <array>
#include <cctype>

#include <dlfcn.h>
#include <fmt/format.h>

#include "format/system/result_macros.h"
#include "player/pictures/picture_module.h"
#include "player/write_png.h"

namespace splatlas {
namespace {

/// The file extension in lower case and in one spelling per format; empty if it is unknown.
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

using Bytes = std::vector<std::byte>;

Result<Bytes> encode_through_module(void* function, const std::string& ending, const Picture& picture,
                                    std::optional<Rgb> background) {
  const bool is_float = ending == ".exr";
  if (!background && ending == ".jpg") background = Rgb{0, 0, 0};
  std::vector<std::uint8_t> srgb;
  if (!is_float) srgb = background ? to_srgb8(picture, *background) : to_srgba8(picture);
  const void* data = is_float ? static_cast<const void*>(picture.rgba.data()) : srgb.data();
  const PixelsToEncode to_encode{ending.c_str(),      picture.size.width,
                                 picture.size.height, background && !is_float ? 3 : 4,
                                 is_float ? 1 : 0,    data};
  Bytes bytes;
  const auto take = [](void* context, const void* first, std::size_t size) {
    const auto* const begin = static_cast<const std::byte*>(first);
    static_cast<Bytes*>(context)->assign(begin, begin + size);
  };
  std::array<char, 512> error{};
  const auto encode_pixels = reinterpret_cast<EncodePixels>(function);
  if (encode_pixels(&to_encode, take, &bytes, error.data(), error.size()) != 0) {
    return fail(ErrorCode::kFailed, error.data());
  }
  return bytes;
}

}  // namespace

PictureEncoder::PictureEncoder(std::filesystem::path path)
    : path_(std::move(path)), ending_(known_ending(path_)) {
  if (!ending_.empty() && ending_ != ".png") module_ = std::async(std::launch::async, load_module);
}

bool PictureEncoder::is_opaque(const std::filesystem::path& path) {
  return known_ending(path) == ".jpg";
}

Result<void> PictureEncoder::check_ending(const std::filesystem::path& path) {
  if (!known_ending(path).empty()) return {};
  return fail(ErrorCode::kUsage, fmt::format("{}: unknown picture ending '{}'; use .png, .jpg, .tif or .exr",
                                             path.string(), path.extension().string()));
}

Result<void> PictureEncoder::check_size(const std::filesystem::path& path, const PictureSize& size,
                                        std::optional<Rgb> background) {
  if (known_ending(path) != ".png") return {};
  const Result<void> fits = check_png_size(size, !background);
  if (fits) return {};
  return fail(fits.error().code, fmt::format("{}: {}", path.string(), fits.error().message));
}

Result<std::vector<std::byte>> PictureEncoder::encode(const Picture& picture, std::optional<Rgb> background) {
  SPLATLAS_RETURN_IF_ERROR(check_ending(path_));
  auto bytes = encode_pixels(picture, background);
  if (bytes) return bytes;
  return fail(ErrorCode::kFailed,
              fmt::format("{}: cannot be encoded: {}", path_.string(), bytes.error().message));
}

Result<Bytes> PictureEncoder::encode_pixels(const Picture& picture, std::optional<Rgb> background) {
  if (!module_.valid()) return encode_png(picture, background);
  SPLATLAS_ASSIGN_OR_RETURN(void* const function, module_.get());
  return encode_through_module(function, ending_, picture, background);
}

}  // namespace splatlas

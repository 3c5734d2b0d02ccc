#include "player/write_picture.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <string>

#include "format/io/output_file.h"
#include "format/result_macros.h"
#include "player/files/draw_annotations.h"
#include "player/files/picture_encoder.h"
#include "player/write_png.h"

namespace splatlas {
namespace {

using Bytes = std::vector<std::byte>;

/// A file with one channel.
Result<Bytes> encode_exr(const PictureSize& size, PixelType type, const void* pixels) {
  SPLATLAS_ASSIGN_OR_RETURN(void* const function,
                            load_function(kPictureModule, kEncodePixelsName, "OpenImageIO"));
  return encode_pixels(function, {".exr", size.width, size.height, 1, type, pixels, 0});
}

/// The encoded file, or an error that names it.
Result<Bytes> named(Result<Bytes> bytes, const std::filesystem::path& path) {
  if (bytes) return bytes;
  return fail(bytes.error().code, "{}: cannot be encoded: {}", path.string(), bytes.error().message);
}

}  // namespace

Result<void> write_picture(const Picture& picture, const std::filesystem::path& path,
                           std::optional<Rgb> background) {
  SPLATLAS_RETURN_IF_ERROR(PictureEncoder::check_ending(path));
  SPLATLAS_RETURN_IF_ERROR(PictureEncoder::check_size(path, picture.size, background));
  SPLATLAS_ASSIGN_OR_RETURN(const Bytes bytes,
                            named(PictureEncoder(path).encode_file(picture, background), path));
  return write_file(path, bytes);
}

Result<void> check_id_ending(const std::filesystem::path& path) {
  const std::string ending = lower_ending(path);
  if (ending == ".png" || ending == ".exr") return {};
  return fail(ErrorCode::kUsage, "{}: unknown ending '{}' of an id image; use .png or .exr", path.string(),
              path.extension().string());
}

Result<Bytes> encode_ids(const IdImage& ids, const std::filesystem::path& path) {
  SPLATLAS_RETURN_IF_ERROR(check_id_ending(path));
  if (lower_ending(path) == ".png") return named(encode_png(ids), path);
  const std::vector<std::uint32_t> numbers(ids.numbers.begin(), ids.numbers.end());
  return named(encode_exr(ids.size, kNumberPixels, numbers.data()), path);
}

Result<void> check_depth_ending(const std::filesystem::path& path) {
  if (lower_ending(path) == ".exr") return {};
  return fail(ErrorCode::kUsage, "{}: unknown ending '{}' of a depth map; use .exr", path.string(),
              path.extension().string());
}

Result<Bytes> encode_depths(const DepthMap& depths, const std::filesystem::path& path) {
  SPLATLAS_RETURN_IF_ERROR(check_depth_ending(path));
  std::vector<float> towards_eye(depths.mm.size());
  std::ranges::transform(depths.mm, towards_eye.begin(), [](float mm) {
    return mm == DepthMap::kBackground ? std::numeric_limits<float>::quiet_NaN() : -mm;
  });
  return named(encode_exr(depths.size, kDepthPixels, towards_eye.data()), path);
}

}  // namespace splatlas

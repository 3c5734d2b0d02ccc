#include "player/write_png.h"

#include <cstdint>
#include <cstdio>
#include <limits>
#include <memory>
#include <new>
#include <span>

#include <png.h>

#include "format/io/output_file.h"
#include "format/result_macros.h"
#include "format/tasks/task_control.h"

namespace splatlas {
namespace {

/// Appends what libpng writes to a vector; 0 without memory, and in a task that is to stop.
ssize_t append(void* bytes, const char* data, std::size_t size) try {
  const std::span piece = std::as_bytes(std::span(data, size));
  auto& all = *static_cast<std::vector<std::byte>*>(bytes);
  if (is_task_stopped()) return 0;
  all.insert(all.end(), piece.begin(), piece.end());
  return static_cast<ssize_t>(size);
} catch (const std::bad_alloc&) {
  return 0;
}

Result<std::vector<std::byte>> encode(const PictureSize& picture_size, png_uint_32 format,
                                      const void* pixels) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(picture_size.width);
  image.height = static_cast<png_uint_32>(picture_size.height);
  image.format = format;
  std::vector<std::byte> bytes;
  const std::unique_ptr<FILE, int (*)(FILE*)> file(
      ::fopencookie(&bytes, "wb", {.read = nullptr, .write = append, .seek = nullptr, .close = nullptr}),
      std::fclose);
  if (png_image_write_to_stdio(&image, file.get(), 0, pixels, 0, nullptr) == 0 ||
      std::fflush(file.get()) != 0) {
    if (is_task_stopped()) throw Cancelled();
    // libpng is out of memory, or the picture is empty.
    return fail(image.width == 0 || image.height == 0 ? ErrorCode::kFailed : ErrorCode::kLimit,
                image.message);
  }
  return bytes;
}

}  // namespace

Result<void> check_png_size(const PictureSize& size, bool alpha) {
  const std::uint64_t row_bytes = static_cast<std::uint64_t>(size.width) * (alpha ? 4 : 3);
  if (row_bytes * static_cast<std::uint64_t>(size.height) <= std::numeric_limits<std::uint32_t>::max())
    return {};
  return fail(ErrorCode::kUsage,
              "picture size {}x{}: PNG with a transparent background holds less than 2^32 bytes of "
              "pixels; take a smaller size, a colour as background or .exr",
              size.width, size.height);
}

Result<std::vector<std::byte>> encode_png(const Picture& picture, std::optional<Rgb> background) {
  const std::vector<std::uint8_t> pixels = background ? to_srgb8(picture, *background) : to_srgba8(picture);
  return encode(picture.size, background ? PNG_FORMAT_RGB : PNG_FORMAT_RGBA, pixels.data());
}

Result<std::vector<std::byte>> encode_png(const IdImage& ids) {
  return encode(ids.size, PNG_FORMAT_LINEAR_Y, ids.numbers.data());
}

Result<void> write_png(const Picture& picture, const std::filesystem::path& path,
                       std::optional<Rgb> background) {
  const auto bytes = encode_png(picture, background);
  if (bytes) return write_file(path, *bytes);
  return fail(bytes.error().code, "{}: cannot be encoded: {}", path.string(), bytes.error().message);
}

}  // namespace splatlas

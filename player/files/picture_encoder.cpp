#include "player/files/picture_encoder.h"

#include <cmath>
#include <cstring>
#include <span>

#include <zlib.h>

#include "format/result_macros.h"
#include "format/tasks/task_control.h"
#include "format/text/ascii_text.h"
#include "player/write_png.h"

namespace splatlas {
namespace {

/// The file extension in lower case and in one spelling per format; empty if it is unknown.
std::string known_ending(const std::filesystem::path& path) {
  std::string ending = lower_ending(path);
  if (ending == ".jpeg") ending = ".jpg";
  if (ending == ".tiff") ending = ".tif";
  for (const char* known : {".png", ".jpg", ".tif", ".exr", ".svg", ".pdf"}) {
    if (ending == known) return ending;
  }
  return {};
}

using Bytes = std::vector<std::byte>;

Result<Bytes> encode_through_module(void* function, const std::string& ending, const Picture& picture,
                                    std::optional<Rgb> background, double dpi) {
  const bool is_float = ending == ".exr";
  if (!background && ending == ".jpg") background = Rgb{0, 0, 0};
  std::vector<std::uint8_t> srgb;
  if (!is_float) srgb = background ? to_srgb8(picture, *background) : to_srgba8(picture);
  const void* data = is_float ? static_cast<const void*>(picture.rgba.data()) : srgb.data();
  const PixelsToEncode to_encode{ending.c_str(),
                                 picture.size.width,
                                 picture.size.height,
                                 background && !is_float ? 3 : 4,
                                 is_float ? kFloatPixels : kBytePixels,
                                 data,
                                 is_float ? 0 : dpi};
  return encode_pixels(function, to_encode);
}

/// Adds the chunk pHYs, pixels per metre, behind the header of a PNG file (PNG specification, 11.3.5.3).
void add_resolution(Bytes& png, double dpi) {
  constexpr std::size_t kHeaderEnd = 33;  // signature and IHDR
  constexpr double kInchesPerMetre = 1 / 0.0254;
  if (png.size() < kHeaderEnd) return;
  std::vector<unsigned char> chunk{0, 0, 0, 9, 'p', 'H', 'Y', 's'};
  const auto add = [&](std::uint32_t value) {
    for (int shift = 24; shift >= 0; shift -= 8) chunk.push_back(static_cast<unsigned char>(value >> shift));
  };
  const auto per_metre = static_cast<std::uint32_t>(std::lround(dpi * kInchesPerMetre));
  add(per_metre), add(per_metre);
  chunk.push_back(1);  // the unit is the metre
  add(static_cast<std::uint32_t>(crc32(0, chunk.data() + 4, static_cast<unsigned>(chunk.size() - 4))));
  const std::span bytes = std::as_bytes(std::span(chunk));
  png.insert(png.begin() + kHeaderEnd, bytes.begin(), bytes.end());
}

double document_dpi(const FileAnnotations& annotations) {
  constexpr double kDefaultDpi = 300;
  return annotations.dpi.value_or(kDefaultDpi);
}

Result<Bytes> encode_svg(const Picture& picture, std::optional<Rgb> background,
                         const FileAnnotations& annotations) {
  SPLATLAS_ASSIGN_OR_RETURN(const Bytes png, encode_png(picture, background));
  const AnnotationLayer none;
  const std::string svg = svg_document(png, picture.size, document_dpi(annotations),
                                       annotations.layer ? *annotations.layer : none);
  const std::span bytes = std::as_bytes(std::span(svg));
  return Bytes(bytes.begin(), bytes.end());
}

Result<Bytes> encode_pdf(TextDrawer& drawer, const Picture& picture, std::optional<Rgb> background,
                         const FileAnnotations& annotations) {
  SPLATLAS_RETURN_IF_ERROR(drawer.wait());
  const AnnotationLayer none;
  PdfPage page{picture.size,
               document_dpi(annotations),
               {},
               annotations.title,
               annotations.layer ? annotations.layer : &none,
               annotations.texts,
               annotations.is_last};
  if (background) {
    const std::vector<std::uint8_t> srgb = to_srgb8(picture, *background);
    page.rgba.assign(srgb.size() / 3 * 4, 255);
    for (std::size_t n = 0; n < srgb.size() / 3; ++n) std::memcpy(&page.rgba[4 * n], &srgb[3 * n], 3);
  } else {
    page.rgba = to_srgba8(picture);
  }
  return drawer->encode_pdf(page);
}

}  // namespace

std::string lower_ending(const std::filesystem::path& path) {
  return to_lower(path.extension().string());
}

Result<Bytes> encode_pixels(void* function, const PixelsToEncode& pixels) {
  Bytes bytes;
  const auto take = [](void* context, const void* first, std::size_t size) {
    const auto* const begin = static_cast<const std::byte*>(first);
    static_cast<Bytes*>(context)->assign(begin, begin + size);
  };
  std::array<char, 512> error{};
  const int status = reinterpret_cast<EncodePixels>(function)(&pixels, take, &bytes, is_task_stopped,
                                                              error.data(), error.size());
  if (is_task_stopped()) throw Cancelled();
  if (status != 0) return fail(ErrorCode::kFailed, error.data());
  return bytes;
}

PictureEncoder::PictureEncoder(std::filesystem::path path)
    : path_(std::move(path)), ending_(known_ending(path_)) {
  if (ending_ != ".jpg" && ending_ != ".tif" && ending_ != ".exr") return;
  module_ = std::async(std::launch::async,
                       [] { return load_function(kPictureModule, kEncodePixelsName, "OpenImageIO"); });
}

bool PictureEncoder::is_opaque(const std::filesystem::path& path) {
  return known_ending(path) == ".jpg";
}

bool PictureEncoder::is_linear(const std::filesystem::path& path) {
  return known_ending(path) == ".exr";
}

Result<void> PictureEncoder::check_ending(const std::filesystem::path& path) {
  if (!known_ending(path).empty()) return {};
  return fail(ErrorCode::kUsage, "{}: unknown picture ending '{}'; use .png, .jpg, .tif, .exr, .svg or .pdf",
              path.string(), path.extension().string());
}

Result<void> PictureEncoder::check_size(const std::filesystem::path& path, const PictureSize& size,
                                        std::optional<Rgb> background) {
  const std::string ending = known_ending(path);
  if (ending != ".png" && ending != ".svg" && ending != ".pdf") return {};
  const Result<void> fits = check_png_size(size, !background);
  if (fits) return {};
  return fail(fits.error().code, "{}: {}", path.string(), fits.error().message);
}

Result<std::vector<std::byte>> PictureEncoder::encode(Picture& picture, std::optional<Rgb> background,
                                                      const FileAnnotations& annotations) {
  SPLATLAS_RETURN_IF_ERROR(check_ending(path_));
  const auto draw_and_encode = [&]() -> Result<Bytes> {
    if (annotations.layer != nullptr && ending_ != ".svg" && ending_ != ".pdf") {
      const std::optional<Rgb> under = ending_ == ".exr" ? std::nullopt : background;
      SPLATLAS_RETURN_IF_ERROR(draw_annotations(picture, *annotations.layer, under, annotations.drawer));
    }
    return encode_file(picture, background, annotations);
  };
  auto bytes = draw_and_encode();
  if (bytes) return bytes;
  return fail(ErrorCode::kFailed, "{}: cannot be encoded: {}", path_.string(), bytes.error().message);
}

Result<Bytes> PictureEncoder::encode_file(const Picture& picture, std::optional<Rgb> background,
                                          const FileAnnotations& annotations) {
  if (ending_ == ".svg") return encode_svg(picture, background, annotations);
  if (ending_ == ".pdf") {
    if (annotations.drawer != nullptr)
      return encode_pdf(*annotations.drawer, picture, background, annotations);
    TextDrawer drawer({});
    return encode_pdf(drawer, picture, background, annotations);
  }
  if (ending_ == ".png") {
    SPLATLAS_ASSIGN_OR_RETURN(Bytes png, encode_png(picture, background));
    if (annotations.dpi) add_resolution(png, *annotations.dpi);
    return png;
  }
  SPLATLAS_ASSIGN_OR_RETURN(void* const function, module_.get());
  return encode_through_module(function, ending_, picture, background, annotations.dpi.value_or(0));
}

}  // namespace splatlas

#include "player/files/picture_module.h"

#include <algorithm>
#include <cstdio>
#include <exception>
#include <memory>
#include <string>
#include <vector>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

namespace {

constexpr const char* kNoMemory = "out of memory; take a smaller picture";

/// Writes the first line of an error. Plugins describe an allocation failure in various ways, or not at all.
void report(char* error, std::size_t error_size, std::string text) {
  text = text.substr(0, text.find('\n'));
  if (text.find("bad_alloc") != std::string::npos) text = kNoMemory;
  std::snprintf(error, error_size, "%s", text.empty() ? "no reason is known" : text.c_str());
}

OIIO::ImageSpec spec_of(const splatlas::PixelsToEncode& pixels, const std::string& ending) {
  const bool is_byte = pixels.type == splatlas::kBytePixels;
  const bool is_number = pixels.type == splatlas::kNumberPixels,
             is_depth = pixels.type == splatlas::kDepthPixels;
  OIIO::ImageSpec spec(pixels.width, pixels.height, pixels.channels,
                       is_byte     ? OIIO::TypeDesc::UINT8
                       : is_number ? OIIO::TypeDesc::UINT32
                                   : OIIO::TypeDesc::FLOAT);
  if (is_number || is_depth) spec.channelnames = {is_number ? "id" : "Z"};
  // In TIFF this attribute is EXIF, which OpenImageIO 2.4 corrupts in memory. 8-bit TIFF is sRGB by default.
  if (ending != ".tif" && !is_number && !is_depth)
    spec.attribute("oiio:ColorSpace", is_byte ? "sRGB" : "Linear");
  spec.attribute("Software", "Splatlas");
  spec.attribute("DateTime", "");  // for reproducible files
  if (is_byte) spec.attribute("oiio:UnassociatedAlpha", 1);
  if (ending == ".jpg") spec.attribute("CompressionQuality", 95);
  if (ending == ".exr") spec.attribute("compression", "zip");
  if (pixels.dpi > 0) {
    spec.attribute("XResolution", static_cast<float>(pixels.dpi));
    spec.attribute("YResolution", static_cast<float>(pixels.dpi));
    spec.attribute("ResolutionUnit", "in");
  }
  return spec;
}

}  // namespace

// Encodes to memory, because libjpeg terminates the program if the disk is full.
extern "C" __attribute__((visibility("default"))) int splatlas_encode_pixels(
    const splatlas::PixelsToEncode* pixels, splatlas::TakeBytes take, void* context,
    splatlas::IsStopped is_stopped, char* error, std::size_t error_size) try {
  // Create the output for the format
  const std::string ending = pixels->ending;
  const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create(ending.substr(1));
  if (!output) {
    report(error, error_size, OIIO::geterror());
    return 1;
  }

  // Write through a memory proxy
  OIIO::ImageSpec spec = spec_of(*pixels, ending);
  std::vector<unsigned char> bytes;
  OIIO::Filesystem::IOVecOutput memory(bytes);
  OIIO::Filesystem::IOProxy* proxy = &memory;
  spec.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
  bool is_written = output->open("picture" + ending, spec);
  constexpr int kRows = 64;  // in tens of milliseconds; whole strips of every format
  const auto* row = static_cast<const std::byte*>(pixels->pixels);
  for (int y = 0; is_written && y < spec.height && !is_stopped();
       y += kRows, row += kRows * spec.scanline_bytes())
    is_written = output->write_scanlines(y, std::min(y + kRows, spec.height), 0, spec.format, row);
  if (!is_written || !output->close()) {
    report(error, error_size, output->geterror());
    return 1;
  }
  take(context, bytes.data(), bytes.size());
  return 0;
} catch (const std::exception& exception) {
  report(error, error_size, exception.what());
  return 1;
}

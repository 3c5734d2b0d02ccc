#include "player/pictures/picture_module.h"

#include <cstdio>
#include <exception>
#include <memory>
#include <string>
#include <vector>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

namespace {

constexpr const char* kNoMemory = "out of memory; take a smaller picture";

/// Plugins tell want of memory in words of their own, or not at all.
void tell(char* error, std::size_t error_size, std::string text) {
  text = text.substr(0, text.find('\n'));
  if (text.find("bad_alloc") != std::string::npos) text = kNoMemory;
  std::snprintf(error, error_size, "%s", text.empty() ? "no reason is known" : text.c_str());
}

OIIO::ImageSpec spec_of(const splatlas::PixelsToEncode& pixels, const std::string& ending) {
  const bool is_float = pixels.is_float != 0;
  OIIO::ImageSpec spec(pixels.width, pixels.height, pixels.channels,
                       is_float ? OIIO::TypeDesc::FLOAT : OIIO::TypeDesc::UINT8);
  // In TIFF this would be EXIF, and OpenImageIO 2.4 breaks files with EXIF that it writes to
  // memory; 8-bit TIFF is sRGB where it says nothing.
  if (ending != ".tif") spec.attribute("oiio:ColorSpace", is_float ? "Linear" : "sRGB");
  spec.attribute("Software", "Splatlas");
  spec.attribute("DateTime", "");  // the same picture is the same file, whenever it is made
  if (!is_float) spec.attribute("oiio:UnassociatedAlpha", 1);
  if (ending == ".jpg") spec.attribute("CompressionQuality", 95);
  if (ending == ".exr") spec.attribute("compression", "zip");
  return spec;
}

}  // namespace

// Into memory: libjpeg's way with a full disk is to end the program.
extern "C" __attribute__((visibility("default"))) int splatlas_encode_pixels(
    const splatlas::PixelsToEncode* pixels, splatlas::TakeBytes take, void* context, char* error,
    std::size_t error_size) try {
  const std::string ending = pixels->ending;
  const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create(ending.substr(1));
  if (!output) {
    tell(error, error_size, OIIO::geterror());
    return 1;
  }
  OIIO::ImageSpec spec = spec_of(*pixels, ending);
  std::vector<unsigned char> bytes;
  OIIO::Filesystem::IOVecOutput memory(bytes);
  OIIO::Filesystem::IOProxy* proxy = &memory;
  spec.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
  if (!output->open("picture" + ending, spec) || !output->write_image(spec.format, pixels->pixels) ||
      !output->close()) {
    tell(error, error_size, output->geterror());
    return 1;
  }
  take(context, bytes.data(), bytes.size());
  return 0;
} catch (const std::exception& exception) {
  tell(error, error_size, exception.what());
  return 1;
}

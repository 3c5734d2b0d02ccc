#include "player/pictures/picture_module.h"

#include <cstdio>
#include <exception>
#include <memory>
#include <string>

#include <OpenImageIO/imageio.h>

namespace {

void tell(char* error, std::size_t error_size, const std::string& text) {
  std::snprintf(error, error_size, "%s", text.substr(0, text.find('\n')).c_str());
}

}  // namespace

extern "C" __attribute__((visibility("default"))) int splatlas_write_pixels(
    const char* path, const char* ending, int width, int height, int channels, int is_float,
    const void* pixels, char* error, std::size_t error_size) try {
  const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create(ending + 1);  // without the dot
  if (!output) {
    tell(error, error_size, OIIO::geterror());
    return 1;
  }
  const OIIO::TypeDesc type = is_float != 0 ? OIIO::TypeDesc::FLOAT : OIIO::TypeDesc::UINT8;
  OIIO::ImageSpec spec(width, height, channels, type);
  spec.attribute("oiio:ColorSpace", is_float != 0 ? "Linear" : "sRGB");
  spec.attribute("Software", "Splatlas");
  spec.attribute("DateTime", "");  // the same picture is the same file, whenever it is made
  if (is_float == 0) spec.attribute("oiio:UnassociatedAlpha", 1);
  if (std::string(ending) == ".jpg") spec.attribute("CompressionQuality", 95);
  if (std::string(ending) == ".exr") spec.attribute("compression", "zip");
  if (!output->open(path, spec) || !output->write_image(type, pixels) || !output->close()) {
    tell(error, error_size, output->geterror());
    return 1;
  }
  return 0;
} catch (const std::exception& exception) {
  tell(error, error_size, exception.what());
  return 1;
}

// Pictures read back through OpenImageIO.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <OpenImageIO/imageio.h>

namespace splatlas {

/// Interleaved channels as stored (8-bit values scaled to [0, 1]); empty when the file cannot be read.
inline std::vector<float> read_pixels(const std::string& path) {
  OIIO::ImageSpec as_stored;
  as_stored.attribute("oiio:UnassociatedAlpha", 1);
  const auto input = OIIO::ImageInput::open(path, &as_stored);
  if (!input) return {};
  const OIIO::ImageSpec& spec = input->spec();
  std::vector<float> pixels(static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height) *
                            static_cast<std::size_t>(spec.nchannels));
  return input->read_image(0, 0, 0, -1, OIIO::TypeDesc::FLOAT, pixels.data()) ? pixels : std::vector<float>{};
}

}  // namespace splatlas

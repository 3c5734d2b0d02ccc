// Pictures in linear RGB, id images, depth maps, picked structures and missing parts.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "format/content/color.h"
#include "format/content/grid.h"
#include "format/content/structure_graph.h"
#include "format/result.h"
#include "player/camera.h"

namespace splatlas {

/// RGBA floats: linear sRGB primaries, premultiplied by alpha (Porter and Duff 1984); top row first.
struct Picture {
  PictureSize size;
  std::vector<float> rgba;  ///< 4 * width * height values

  /// The pixel in column x and row y, both in range.
  [[nodiscard]] std::array<float, 4> at(int x, int y) const {
    const std::size_t n = 4 * size.pixel(x, y);
    return {rgba[n], rgba[n + 1], rgba[n + 2], rgba[n + 3]};
  }
};

/// Number of a structure in an id image: StructureIndex + 1; 0: none.
using StructureNumber = std::uint16_t;
/// Maximum number of structures of an atlas with id images.
inline constexpr std::size_t kMaxNumberedStructures = 65534;

/// Structure of each pixel: the one with the largest share of the pixel's opacity (docs/model.md). 0 where
/// the opacity is below 1/255. Top row first.
struct IdImage {
  PictureSize size{0, 0};
  std::vector<StructureNumber> numbers;  ///< width * height; empty: none

  [[nodiscard]] bool empty() const { return numbers.empty(); }
  /// The structure in column x and row y, both in range; kNoStructure for the background.
  [[nodiscard]] StructureIndex at(int x, int y) const {
    const StructureNumber number = numbers[size.pixel(x, y)];
    return number == 0 ? kNoStructure : StructureIndex{number} - 1;
  }
};

/// Depth of each pixel: where the transmittance of its ray falls to one half; kBackground if it stays above.
/// In mm along the view direction, from the plane through the view's centre. kBackground also where the
/// opacity is below 1/255. Top row first.
struct DepthMap {
  static constexpr float kBackground = std::numeric_limits<float>::infinity();
  PictureSize size{0, 0};
  std::vector<float> mm;  ///< width * height; empty: none

  [[nodiscard]] bool empty() const { return mm.empty(); }
  /// Sets all pixels to background.
  void clear(const PictureSize& picture_size) {
    size = picture_size;
    mm.assign(size.pixels(), kBackground);
  }
};

/// Structure with the largest contribution to a pixel.
struct Pick {
  StructureIndex structure = kNoStructure;
  Vec3 point_lps_mm{0, 0, 0};  ///< point on the ray where the structure contributes most
};

/// Volume or surface of a selected structure that cannot be read.
struct MissingPart {
  StructureIndex structure = kNoStructure;
  bool surface = false;      ///< true: its surface; false: voxels of its volume
  std::uint64_t voxels = 0;  ///< number of missing voxels; 0 for a surface
  Error error;               ///< error of its first unreadable stream
};

/// One line with structure, part and error, such as: "Vermis_3": its volume of 1234 voxels is missing:
/// a.atlas: damaged: checksum of values of classes 3 to 4.
[[nodiscard]] std::string describe(const MissingPart& missing, const StructureGraph& graph);

/// Bytes to render and encode a picture of this size: its floats, and the same amount for the encoder.
[[nodiscard]] constexpr std::uint64_t picture_bytes(const PictureSize& size) {
  constexpr std::uint64_t kBytesPerPixel = std::uint64_t{2} * 4 * sizeof(float);
  return kBytesPerPixel * size.pixels();
}

/// Composites the picture over a background and converts it to 8-bit sRGB triples (IEC 61966-2-1). Values are
/// clamped to [0, 1] and rounded here; NaN counts as 0. O(pixels), thread-safe.
[[nodiscard]] std::vector<std::uint8_t> to_srgb8(const Picture& picture, Rgb background);

/// Converts the picture to 8-bit sRGB with straight (not premultiplied) alpha, for transparent backgrounds.
/// Clamps and rounds as to_srgb8(). O(pixels), thread-safe.
[[nodiscard]] std::vector<std::uint8_t> to_srgba8(const Picture& picture);
/// The same of pixels as Picture::rgba has them, for viewers: a new buffer costs page faults in every frame.
/// Writes rgba.size() bytes from `out` on.
void to_srgba8(std::span<const float> rgba, std::uint8_t* out);

}  // namespace splatlas

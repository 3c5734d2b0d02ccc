// Sheet pixels behind opaque faces of a cut.
#pragma once

#include <cstdint>
#include <vector>

#include "player/render/clip/face_layer.h"
#include "player/render/sheets/band_image.h"
#include "player/render/view/shear.h"
#include "player/render/view/sheet_window.h"

namespace splatlas {

/// The sheet pixels that nothing shows, since opaque faces lie in front of all picture pixels that may sample
/// them. Nothing is in front of a face.
class HiddenPixels {
 public:
  /// Cost: linear in the pixels of the picture.
  explicit HiddenPixels(const FaceLayer& faces);

  /// Makes the hidden pixels of a band opaque, so that nothing is splatted there.
  void close(const Shear& shear, const SheetWindow& window, BandImage& image) const;

 private:
  [[nodiscard]] bool is_hidden(double x, double y, int reach_x, int reach_y) const;

  std::int64_t columns_, rows_;
  std::vector<std::uint32_t> open_;  // pixels without an opaque face, above and left of each corner of pixels
};

}  // namespace splatlas

// Reference pictures: ground truth and discrete model.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "format/content/atlas_content.h"
#include "format/content/selection.h"
#include "player/render/view/pixel_box.h"
#include "player/renderer.h"

namespace splatlas::reference {

/// Linear RGBA, premultiplied, top row first.
struct ReferencePicture {
  PictureSize size;
  std::vector<std::array<double, 4>> pixels;
};

/// Inputs of a frame.
struct ReferenceScene {
  const AtlasContent& content;
  const Selection& selection;
  Camera camera{};
  RenderOptions options{};
};

/// Ground truth: the trilinear field along the ray of each pixel centre, with all surfaces it crosses.
[[nodiscard]] ReferencePicture render_truth(const ReferenceScene& scene);
/// Ground truth averaged over a grid of rays in each pixel.
[[nodiscard]] ReferencePicture render_mean_truth(const ReferenceScene& scene, int columns, int rows);
[[nodiscard]] inline ReferencePicture render_mean_truth(const ReferenceScene& scene, int n) {
  return render_mean_truth(scene, n, n);
}

/// The discrete model, without antialiasing (see DiscreteModel).
[[nodiscard]] ReferencePicture render_model(const ReferenceScene& scene);
/// The discrete model averaged over samples at `places`, as for edge pixels.
[[nodiscard]] ReferencePicture render_model(const ReferenceScene& scene, std::span<const SubPixel> places);
/// The discrete model with sheets of unlimited resolution: slabs are the only approximation.
[[nodiscard]] ReferencePicture render_slabs(const ReferenceScene& scene);

}  // namespace splatlas::reference

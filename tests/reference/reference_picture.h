// Whole pictures of the truth and of the discrete model.
#pragma once

#include <array>
#include <vector>

#include "format/atlas_content.h"
#include "format/selection.h"
#include "player/render_frame.h"

namespace splatlas::reference {

/// RGBA, linear light, premultiplied; top row first.
struct ReferencePicture {
  PictureSize size;
  std::vector<std::array<double, 4>> pixels;
};

/// What a frame is made from.
struct ReferenceScene {
  const AtlasContent& content;
  const Selection& selection;
  Camera camera{};
  RenderOptions options{};
};

/// The truth: the trilinear field of the selected voxels along the ray of every pixel's centre, with every
/// surface where the ray crosses it.
[[nodiscard]] ReferencePicture render_truth(const ReferenceScene& scene);

/// What the renderer computes, in double precision (see DiscreteModel).
[[nodiscard]] ReferencePicture render_model(const ReferenceScene& scene);
/// The same with sheets of unlimited resolution: slabs are what is left of the approximations.
[[nodiscard]] ReferencePicture render_slabs(const ReferenceScene& scene);

}  // namespace splatlas::reference

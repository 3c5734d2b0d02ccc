// Whole pictures of the truth and of the discrete model.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "format/atlas_content.h"
#include "format/selection.h"
#include "player/render_frame.h"
#include "player/view/sample_pattern.h"

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
/// The mean of n * n rays of every pixel.
[[nodiscard]] ReferencePicture render_mean_truth(const ReferenceScene& scene, int n);

/// What the renderer computes without antialiasing, in double precision (see DiscreteModel).
[[nodiscard]] ReferencePicture render_model(const ReferenceScene& scene);
/// The same as if every pixel were at an edge: the mean of samples at `places`.
[[nodiscard]] ReferencePicture render_model(const ReferenceScene& scene, std::span<const SubPixel> places);
/// The same with sheets of unlimited resolution: slabs are what is left of the approximations.
[[nodiscard]] ReferencePicture render_slabs(const ReferenceScene& scene);

}  // namespace splatlas::reference

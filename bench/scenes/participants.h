// Renderers that draw one scene, with their times and errors.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "bench/measure/frames.h"
#include "bench/peers/volpack_peer.h"
#include "bench/peers/vtk_peer.h"
#include "bench/scenes/error_scenes.h"
#include "player/renderer.h"
#include "tests/reference/picture_difference.h"

namespace splatlas {

/// Result of one renderer at one setting.
struct RendererCost {
  std::string renderer;  ///< "splatlas", "splatlas rays", "VolPack", "VTK FixedPoint", "VTK GPU", ...
  std::string setting;   ///< quality, or sample distance
  unsigned threads = 1;
  Elapsed frame = {};                       ///< medians over frames
  reference::PictureDifference error = {};  ///< RMS and mean of full scale, over the compared views
};

/// A renderer, with selection, decoding, classification and upload done.
struct Participant {
  RendererCost cost;
  std::function<Result<void>(const Camera& camera)> draw;
  std::function<Picture()> picture;  ///< latest picture
  /// Draws for the comparison, with unlit truth, if draw() has a shading of its own.
  std::function<Result<void>(const Camera& camera)> draw_unlit = nullptr;
  std::function<const RenderStats*()> stats = nullptr;  ///< statistics of the latest picture; may be empty
};

/// Inputs of all participants. References must outlive them.
struct ErrorTask {
  const std::shared_ptr<const Atlas>& atlas;
  const ErrorModel& model;
  PictureSize size;
  int frames = 7, repeats = 1;

  [[nodiscard]] int turns() const { return frames * repeats; }
  [[nodiscard]] Camera camera(int turn) const { return turned(model.camera, turn, frames); }
  [[nodiscard]] Result<ParallelView> view(const Camera& camera) const {
    return parallel_view(camera, size, atlas->display());
  }
};

/// Vertical field of view of perspective pictures, degrees.
inline constexpr double kVerticalFovDeg = 30;

/// Adds Splatlas at every setting, on `threads` threads: in parallel projection with pre-classification, or
/// in perspective with post-classification ("splatlas rays"). Draws once per principal axis (rays: once) and
/// setting in advance.
[[nodiscard]] Result<void> add_ours(const ErrorTask& task, Classification classification, unsigned threads,
                                    std::vector<Participant>& participants,
                                    std::span<const NamedQuality> settings = kQualities);

/// Adds VolPack, with the shading of the model. Classifies in advance.
[[nodiscard]] Result<void> add_volpack(const ErrorTask& task, std::vector<Participant>& participants);

/// Adds VTK in perspective. It shades by the gradient of the grey values, which is not the model's shading:
/// its error is that of unlit pictures. Draws once in advance.
[[nodiscard]] Result<void> add_vtk(const ErrorTask& task, VtkVolumeMapper mapper, double step_mm,
                                   std::vector<Participant>& participants);

/// Sets the errors of renderers over `views_compared` views, which are every second frame, against ground
/// truth in double precision with the same shading: in parallel projection with pre-classification, or in
/// perspective with post-classification.
[[nodiscard]] Result<void> compare(std::vector<Participant>& participants, const ErrorTask& task,
                                   Classification classification, int views_compared);

/// The costs of all participants, with the times of interleaved frames.
[[nodiscard]] Result<std::vector<RendererCost>> take_times(std::vector<Participant> participants,
                                                           const ErrorTask& task);

}  // namespace splatlas

// Renderers of the bench `error`.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bench/error_scenes.h"
#include "bench/peers/volpack_peer.h"
#include "bench/peers/vtk_peer.h"
#include "format/atlas_reader.h"
#include "player/frame/stopwatch.h"
#include "player/render_frame.h"
#include "tests/reference/picture_difference.h"

namespace splatlas {

/// Result of one renderer at one setting.
struct RendererCost {
  std::string renderer;  ///< "splatlas", "splatlas rays", "VolPack", "VTK FixedPoint", "VTK GPU"
  std::string setting;   ///< quality, or sample distance
  unsigned threads = 1;
  Elapsed frame;                       ///< medians over frames
  Elapsed traversal, sheets, resolve;  ///< parts of it, if the renderer reports them (ours)
  reference::PictureDifference error;  ///< over the compared views
};

/// A renderer, with selection, decoding, classification and upload done.
struct Participant {
  RendererCost cost;
  std::function<Result<void>(const Camera& camera)> draw;
  std::function<Picture()> picture;                     ///< latest picture
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
};

/// Vertical field of view of perspective pictures, degrees.
inline constexpr double kVerticalFovDeg = 30;
[[nodiscard]] Result<reference::PerspectiveView> perspective_view(const Camera& camera,
                                                                  const ErrorTask& task);

/// Adds Splatlas at every quality, on `threads` threads: in parallel projection with pre-classification, or
/// in perspective with post-classification ("splatlas rays"). Draws once per principal axis and quality in
/// advance.
[[nodiscard]] Result<void> add_ours(const ErrorTask& task, unsigned threads,
                                    std::vector<Participant>& participants);
[[nodiscard]] Result<void> add_our_rays(const ErrorTask& task, unsigned threads,
                                        std::vector<Participant>& participants);

/// Classifies in advance.
[[nodiscard]] Result<Participant> volpack_participant(const ErrorTask& task, OpacityRounding rounding);

/// In perspective. Draws once in advance.
[[nodiscard]] Result<Participant> vtk_participant(const ErrorTask& task, VtkVolumeMapper mapper,
                                                  double step_mm);

}  // namespace splatlas

// The renderers whose time is set against their error.
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

/// One renderer at one setting, and what came out.
struct RendererCost {
  std::string renderer;  ///< "splatlas", "splatlas rays", "VolPack", "VTK FixedPoint", "VTK GPU"
  std::string setting;   ///< quality, or distance between samples
  unsigned threads = 1;
  Elapsed frame;                       ///< medians over the frames
  Elapsed traversal, sheets, resolve;  ///< of which, where the renderer tells (ours)
  reference::PictureDifference error;  ///< over the views that were compared
};

/// A renderer that takes part: selected, decoded, classified, uploaded before it is called.
struct Participant {
  RendererCost cost;
  std::function<Result<void>(const Camera& camera)> draw;
  std::function<Picture()> picture;                     ///< the latest
  std::function<const RenderStats*()> stats = nullptr;  ///< of the latest, where there are any
};

/// What all of them draw. References must outlive the participants.
struct ErrorTask {
  const std::shared_ptr<const Atlas>& atlas;
  const ErrorModel& model;
  PictureSize size;
  int frames = 7, repeats = 1;

  [[nodiscard]] int turns() const { return frames * repeats; }
  [[nodiscard]] Camera camera(int turn) const { return turned(model.camera, turn, frames); }
};

/// Vertical field of view of the perspective pictures, in degrees.
inline constexpr double kVerticalFovDeg = 30;
[[nodiscard]] Result<reference::PerspectiveView> perspective_view(const Camera& camera,
                                                                  const ErrorTask& task);

/// Adds ours at every quality, on `threads` threads: in parallel projection, classified before interpolation;
/// or in perspective, classified after it ("splatlas rays"). Draws once per principal axis and quality
/// beforehand.
[[nodiscard]] Result<void> add_ours(const ErrorTask& task, unsigned threads,
                                    std::vector<Participant>& participants);
[[nodiscard]] Result<void> add_our_rays(const ErrorTask& task, unsigned threads,
                                        std::vector<Participant>& participants);

/// Classifies beforehand.
[[nodiscard]] Result<Participant> volpack_participant(const ErrorTask& task, OpacityRounding rounding);

/// In perspective. Draws once beforehand.
[[nodiscard]] Result<Participant> vtk_participant(const ErrorTask& task, VtkVolumeMapper mapper,
                                                  double step_mm);

}  // namespace splatlas

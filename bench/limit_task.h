// One scene beside its limits: its voxels packed into one array, and a dense volume.
#pragma once

#include <map>
#include <memory>
#include <vector>

#include "bench/dense_kernel.h"
#include "bench/error_scenes.h"
#include "bench/packed_spans.h"
#include "format/atlas_reader.h"
#include "player/frame/sheet_frame.h"
#include "player/frame/stopwatch.h"
#include "player/spans/build_spans.h"

namespace splatlas {

/// One scene at one size, normal quality, one thread, without early ray termination: all three composite as
/// many samples onto sheets of equal size. Each turn is a view.
class LimitTask {
 public:
  LimitTask(std::shared_ptr<const Atlas> atlas, ErrorModel model, int size, int frames);

  /// Prepares spans, packed voxels and dense volume for every axis of `turns` turns, and draws once with
  /// each.
  [[nodiscard]] Result<void> prepare(int turns);

  /// Frame, rasterising, sheets, resolve, as in the player.
  [[nodiscard]] Result<std::vector<Elapsed>> draw(int turn);
  /// Sheets of the packed voxels.
  [[nodiscard]] Result<std::vector<Elapsed>> draw_packed(int turn);
  /// The dense kernel.
  [[nodiscard]] Result<std::vector<Elapsed>> draw_dense(int turn);

  /// Sheet pixels per voxel of the latest draw().
  [[nodiscard]] int scale() const { return buffers_.sheet.window.scale; }
  /// Slabs per slice of the latest draw().
  [[nodiscard]] int parts() const { return buffers_.sheet.window.parts; }
  /// Samples of the scene: voxels times sheet pixels per voxel times slabs per slice. Equal for all turns.
  [[nodiscard]] std::uint64_t scene_samples() const;
  /// Share of span blocks that selected voxels fill.
  [[nodiscard]] double fill() const;
  /// Samples of the dense volume of a turn, rounded up to whole slices.
  [[nodiscard]] Result<std::uint64_t> dense_samples(int turn) const;
  /// Composited colours and opacity.
  [[nodiscard]] int planes() const { return 1 + axes_.begin()->second.spans().emissions; }

 private:
  struct Frame {
    ParallelView view;
    Shear shear;
  };
  struct AxisModels {
    SpanBuilder builder;
    PackedSpans packed;
    DenseVolume dense;
    [[nodiscard]] const SpanModel& spans() const { return builder.model(); }
  };
  [[nodiscard]] Result<Frame> frame_of(int turn) const;

  std::shared_ptr<const Atlas> atlas_;
  ErrorModel model_;
  int frames_;
  RenderOptions options_;
  ThreadPool pool_{1};
  std::map<Axis, AxisModels> axes_;
  FrameBuffers buffers_;
  Picture picture_;
  FragmentOrder no_fragments_;
  SheetImage packed_sheet_;
  DenseSheet dense_sheet_;
};

}  // namespace splatlas

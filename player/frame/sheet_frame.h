// Shear-warp rendering of a frame (Lacroute and Levoy 1994).
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "player/frame/frame_buffers.h"
#include "player/frame/shown_frame.h"
#include "player/picture.h"
#include "player/view/view_depth.h"

namespace splatlas {

/// Scene and options of a frame. The spans must be lit. All references must outlive the frame.
struct FrameRequest {
  const SpanModel& spans;
  std::span<const SurfaceDraw> surfaces;
  const ParallelView& view;
  const Shear& shear;
  const Grid& grid;
  const Lighting& lighting;
  const RenderOptions& options;
  std::uint64_t max_memory_bytes = 0;  ///< limit; fragments may take a quarter of it
  bool simd = true;                    ///< false: the scalar reference kernels
};

/// Stages of a frame; call them in this order.
class SheetFrame {
 public:
  SheetFrame(const FrameRequest& request, FrameBuffers& buffers, ThreadPool& pool)
      : request_(request), buffers_(buffers), pool_(pool) {}

  /// Rasterises surfaces to fragments. kLimit for too many fragments.
  [[nodiscard]] Result<void> rasterize();
  /// Splats and composites the spans sheet by sheet (Westover 1990). kLimit when the sheet is too large.
  [[nodiscard]] Result<void> render_sheets();
  /// Warps the sheet into the picture and composites the fragments with it.
  void resolve(Picture& picture);
  /// Merges the depths of the volume into the depth map of the buffers.
  void add_volume_depths(const ViewDepth& view_depth);

  [[nodiscard]] ShownFrame shown() const;
  [[nodiscard]] const FrameCounters& counters() const { return counters_; }

 private:
  const FrameRequest& request_;
  FrameBuffers& buffers_;
  ThreadPool& pool_;
  FrameCounters counters_;
};

}  // namespace splatlas

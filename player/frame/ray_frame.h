// A frame of rays: perspective, and classification after interpolation.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "player/frame/frame_buffers.h"
#include "player/frame/render_overrides.h"
#include "player/frame/shown_frame.h"
#include "player/picture.h"
#include "player/rays/cast_rays.h"
#include "player/rays/march_kernels.h"
#include "player/surfaces/raster_scene.h"
#include "player/view/view_depth.h"

namespace splatlas {

/// Scene and options of a frame. The volume is lit. All references outlive the frame.
struct RayFrameRequest {
  const RayVolume& volume;
  std::span<const SurfaceDraw> surfaces;
  const View& view;
  const Grid& grid;
  const Lighting& lighting;
  const RenderOptions& options;
  const RenderOverrides& overrides;
  std::uint64_t max_memory_bytes = 0;  ///< fragments may take a quarter of it
};

/// Steps of one frame, to be called in this order.
class RayFrame {
 public:
  RayFrame(const RayFrameRequest& request, FrameBuffers& buffers, ThreadPool& pool);

  /// Surfaces to fragments. kUsage when the view is too wide for surfaces, kLimit for too many fragments.
  [[nodiscard]] Result<void> rasterize();
  /// Marches the rays of all pixels through the volume.
  void cast_rays(Picture& picture);
  /// Marches rays from fragment to fragment where there are surfaces.
  void resolve(Picture& picture);
  /// Adds the depths of the volume to those of the buffers.
  void add_volume_depths(const ViewDepth& view_depth);

  [[nodiscard]] ShownFrame shown() const;
  [[nodiscard]] const FrameCounters& counters() const { return counters_; }

 private:
  const RayFrameRequest& request_;
  FrameBuffers& buffers_;
  ThreadPool& pool_;
  const MarchKernels& kernels_;
  const CastOptions options_;
  std::optional<RasterScene> scene_;
  FrameCounters counters_;
};

}  // namespace splatlas

// Ray casting of a frame: perspective projection or post-classification.
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

/// Scene and options of a frame. The volume must be lit. All references must outlive the frame.
struct RayFrameRequest {
  const RayVolume& volume;
  std::span<const SurfaceDraw> surfaces;
  const View& view;
  const Grid& grid;
  const Lighting& lighting;
  const RenderOptions& options;
  const RenderOverrides& overrides;
  std::uint64_t max_memory_bytes = 0;  ///< limit; fragments may take a quarter of it
};

/// Stages of a frame; call them in this order.
class RayFrame {
 public:
  RayFrame(const RayFrameRequest& request, FrameBuffers& buffers, ThreadPool& pool);

  /// Rasterises surfaces to fragments. kUsage when the field of view is too wide for surfaces; kLimit for too
  /// many fragments.
  [[nodiscard]] Result<void> rasterize();
  /// Casts a ray through the volume for each pixel.
  void cast_rays(Picture& picture);
  /// Replaces pixels with surfaces: composites fragments and the ray segments between them.
  void resolve(Picture& picture);
  /// Merges the depths of the volume into the depth map of the buffers.
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

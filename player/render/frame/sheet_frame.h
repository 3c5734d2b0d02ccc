// Shear-warp rendering of a frame (Lacroute and Levoy 1994).
#pragma once

#include <optional>

#include "player/render/frame/frame_renderer.h"
#include "player/render/frame/span_store.h"
#include "player/render/sheets/warp/resolve.h"

namespace splatlas {

/// The spans of the volume, which must outlive the frame, must be lit.
class SheetFrame : public FrameRenderer {
 public:
  SheetFrame(const FrameScene& scene, const SheetVolume& volume, FrameBuffers& buffers, RenderStats& stats,
             ThreadPool& pool)
      : FrameRenderer(scene, buffers, stats, pool), volume_(volume) {}

  /// Splats and composites the spans sheet by sheet (Westover 1990).
  [[nodiscard]] Result<void> render_volume(Picture& picture) override;
  void resolve(Picture& picture) override;
  void resolve_ids(const Picture& picture) override;

 private:
  [[nodiscard]] Result<RasterScene> raster_scene_of_view() const override;
  void add_volume_depths(const ViewDepth& view_depth) override;
  [[nodiscard]] std::uint64_t voxels() const override { return volume_.spans.frame().voxels; }
  [[nodiscard]] std::optional<Axis> slice_axis() const override { return volume_.shear.principal; }

  /// Surface fragments in the volume.
  [[nodiscard]] FragmentsInVolume fragments() const {
    return {buffers_.fragments, buffers_.order, cuts(), faces()};
  }

  void render_shares();

  const SheetVolume& volume_;
};

}  // namespace splatlas

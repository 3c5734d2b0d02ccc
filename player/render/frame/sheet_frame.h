// Shear-warp rendering of a frame (Lacroute and Levoy 1994).
#pragma once

#include <optional>

#include "player/render/frame/frame_renderer.h"
#include "player/render/frame/span_store.h"
#include "player/render/sheets/ids/resolve_ids.h"
#include "player/render/sheets/warp/resolve.h"
#include "player/render/view/sheet_window.h"

namespace splatlas {

/// The spans of the volume, which must outlive the frame, must be lit.
class SheetFrame : public FrameRenderer {
 public:
  SheetFrame(const FrameScene& scene, const SheetVolume& volume, FrameBuffers& buffers, RenderStats& stats,
             ThreadPool& pool)
      : FrameRenderer(scene, buffers, stats, pool), volume_(volume) {}

 private:
  [[nodiscard]] Result<RasterScene> raster_scene_of_view() const override;
  [[nodiscard]] Result<void> begin_volume(Picture& picture) override;
  /// Splats and composites the spans sheet by sheet (Westover 1990), and warps the sheet.
  [[nodiscard]] Result<void> resolve(const PixelBox& region, Picture& picture) override;
  void finish_ids(const Picture& picture) override { fill_rims(picture, buffers_.ids); }
  void add_volume_depths(const ViewDepth& view_depth) override;
  [[nodiscard]] std::uint64_t voxels() const override { return volume_.spans.frame().voxels; }
  [[nodiscard]] std::optional<Axis> slice_axis() const override { return volume_.shear.principal; }

  /// Surface fragments in the volume.
  [[nodiscard]] FragmentsInVolume fragments() const {
    return {buffers_.fragments, buffers_.order, cuts(), faces()};
  }

  void render_sheet(const SheetWindow& window);
  void resolve_ids(const PixelBox& region, const Picture& picture);
  [[nodiscard]] int level() const override { return volume_.detail.level; }

  const SheetVolume& volume_;
  SheetWindow window_;  // of the whole picture
};

}  // namespace splatlas

// Shear-warp rendering of a frame (Lacroute and Levoy 1994).
#pragma once

#include <optional>

#include "player/render/frame/frame_renderer.h"
#include "player/render/frame/span_store.h"
#include "player/render/sheets/warp/sheet_image.h"
#include "player/render/view/shear.h"

namespace splatlas {

/// Shear-warp factorisation of a view. kUsage when it runs along the slices of a forced axis.
[[nodiscard]] Result<Shear> shear_of(const ParallelView& view, const Grid& grid,
                                     const RenderOverrides& overrides);

/// The volume must outlive the frame.
class SheetFrame : public FrameRenderer {
 public:
  SheetFrame(const FrameScene& scene, const SheetVolume& volume, FrameBuffers& buffers, RenderStats& stats,
             ThreadPool& pool)
      : FrameRenderer(scene, volume.grid, buffers, stats, pool), volume_(volume) {}

 private:
  [[nodiscard]] Result<RasterScene> raster_scene_of_view() const override;
  [[nodiscard]] Result<void> begin_volume(Picture& picture) override;
  /// Splats and composites the spans sheet by sheet (Westover 1990), and warps the sheet.
  [[nodiscard]] Result<void> resolve(const PixelBox& region, Picture& picture) override;
  [[nodiscard]] std::uint64_t voxels() const override { return volume_.spans.frame().voxels; }
  [[nodiscard]] std::optional<Axis> slice_axis() const override { return volume_.shear.principal; }

  void walk(const RayScene& scene);
  void render_sheet(const SheetWindow& window);
  [[nodiscard]] int level() const override { return volume_.detail.level; }

  const SheetVolume& volume_;
  SheetWindow window_;  // of the whole picture
  CastOptions walk_;    // of ids and depths
};

}  // namespace splatlas

// Stages of a frame that sheets and rays share: surfaces, depth cue, buffers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "format/atlas_reader.h"
#include "format/tasks/task_control.h"
#include "format/tasks/thread_pool.h"
#include "player/render/clip/cut_faces.h"
#include "player/render/clip/cut_rays.h"
#include "player/render/contributions/fragment_shares.h"
#include "player/render/contributions/shown_frame.h"
#include "player/render/depth_cue/depth_edges.h"
#include "player/render/frame/render_overrides.h"
#include "player/render/sheets/fragment_order.h"
#include "player/render/sheets/ids/sheet_shares.h"
#include "player/render/sheets/sheet_ends.h"
#include "player/render/sheets/warp/sheet_image.h"
#include "player/render/surfaces/raster_scene.h"
#include "player/render/surfaces/rasterize.h"
#include "player/render/view/view_frame.h"

namespace splatlas {

/// Buffers whose memory is reused by the next frame.
struct FrameBuffers {
  Rasterizer rasterizer;
  FragmentList fragments;
  bool has_fragments = false;         ///< of the latest frame; false: it was painted without them
  std::vector<float> surface_depths;  ///< by pixel, if rays end at opaque surfaces
  SheetEnds ends;                     ///< the same, by sheet pixel
  FaceLayer faces;                    ///< of a cut; empty: none
  FragmentOrder order;                ///< depth order of the fragments, and the volume in front of them
  SheetImage sheet;
  SheetShares shares;              ///< of an id image
  FragmentShares fragment_shares;  ///< the same
  IdImage ids;
  DepthMap depths;
};

/// Scene and options of a frame, without its volume. All references must outlive the frame.
struct FrameScene {
  std::span<const SurfaceDraw> surfaces;
  const View& view;
  const Grid& grid;
  const Lighting& lighting;
  const RenderOptions& options;
  const RenderOverrides& overrides;
  std::uint64_t max_memory_bytes = 0;               ///< limit; fragments may take half of it
  std::shared_ptr<const CutFaces> faces = nullptr;  ///< of the cuts of the options; null: none
  /// For an id image: numbers of the structures of the plan's classes; empty: none.
  std::span<const StructureNumber> numbers = {};
};

/// True if the faces of cuts are drawn.
[[nodiscard]] bool shows_faces(const RenderOptions& options);
/// Bytes of a picture, of its encoder, of its depth map and of its faces.
[[nodiscard]] std::uint64_t frame_bytes(const RenderOptions& options);
/// kLimit if these are more than `max_memory_bytes`.
[[nodiscard]] Result<void> check_size(const RenderOptions& options, std::uint64_t max_memory_bytes);

/// kUsage if the options ask for ids and the atlas has too many structures for them.
[[nodiscard]] Result<void> check_ids(const RenderOptions& options, const Atlas& atlas);

/// Stages of a frame; each sets its counter and its time in the statistics.
class FrameRenderer {
 public:
  virtual ~FrameRenderer() = default;

  /// Runs all stages in order. `volume_loops`: loops of render_volume(), for progress.
  [[nodiscard]] Result<void> run(std::size_t volume_loops, TaskControl& task, Picture& picture);

  /// Rasterises surfaces to fragments, or into the picture if nothing else needs them. kUsage when the field
  /// of view is too wide for surfaces; kLimit for too many fragments.
  [[nodiscard]] Result<void> rasterize(Picture& picture);
  /// Renders the volume: into the sheet, or by a ray for each pixel of the picture. kLimit when the sheet is
  /// too large.
  [[nodiscard]] virtual Result<void> render_volume(Picture& picture) = 0;
  /// Composites the fragments with the segments of the volume between them. Warps the sheet into the picture.
  virtual void resolve(Picture& picture) = 0;
  /// Finds the id image of the resolved picture, if the options ask for it.
  virtual void resolve_ids(const Picture& picture) = 0;
  /// Finds the depth map, if the options ask for it or for a depth cue.
  void measure_depths();
  /// Depth darkening (Luft et al. 2006) of the finished picture, if the options ask for it.
  void cue_depth(Picture& picture);

  [[nodiscard]] ShownFrame shown() const;

 protected:
  FrameRenderer(const FrameScene& scene, FrameBuffers& buffers, RenderStats& stats, ThreadPool& pool);

  /// Clips volumes; null without a cut.
  [[nodiscard]] const CutRays* cuts() const { return cuts_ ? &*cuts_ : nullptr; }
  [[nodiscard]] std::span<const VoxelPlane> planes() const {
    return cuts_ ? std::span<const VoxelPlane>(cuts_->planes()) : std::span<const VoxelPlane>();
  }
  /// Faces of the cut at pixel centres; null without any.
  [[nodiscard]] const FaceLayer* faces() const { return buffers_.faces.empty() ? nullptr : &buffers_.faces; }

  [[nodiscard]] virtual Result<RasterScene> raster_scene_of_view() const = 0;
  /// Merges the depths of the volume into the depth map of the buffers.
  virtual void add_volume_depths(const ViewDepth& view_depth) = 0;
  [[nodiscard]] bool paints_surfaces() const;
  [[nodiscard]] bool all_opaque() const;
  /// True if the frame needs no fragments because rays end at opaque surfaces.
  [[nodiscard]] bool ends_at_surfaces() const;
  /// Converts the depths of surfaces to voxels of the volume's level. The fragments are no longer those of
  /// the grid, for picks.
  void scale_depths(int level);
  /// Voxels that contribute to the volume.
  [[nodiscard]] virtual std::uint64_t voxels() const = 0;
  /// Normal of the slices; none for rays.
  [[nodiscard]] virtual std::optional<Axis> slice_axis() const = 0;

  const FrameScene& scene_;
  FrameBuffers& buffers_;
  RenderStats& stats_;
  ThreadPool& pool_;
  std::optional<RasterScene> raster_;

 private:
  std::optional<CutRays> cuts_;
};

/// Rasterises the surfaces of an earlier frame again, with the same fragments. Fails only as that frame
/// would.
[[nodiscard]] Result<void> rasterize_again(const ShownFrame& frame, std::span<const SurfaceDraw> surfaces,
                                           const Grid& grid, FrameBuffers& buffers, ThreadPool& pool);

/// Merges the depths of surfaces and of faces of cuts into `depths` by minimum. The depth of a sample is that
/// of the fragment at which its transmittance falls to one half; a pixel takes its nearest sample.
/// O(fragments).
void add_surface_depths(const FragmentList& fragments, const FaceLayer& faces, const ShownFrame& frame,
                        const ViewDepth& view, DepthMap& depths, ThreadPool& pool);

}  // namespace splatlas

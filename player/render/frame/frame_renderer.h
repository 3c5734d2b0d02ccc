// Stages of a frame that sheets and rays share: surfaces, ids, depths, depth cue, buffers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <optional>
#include <span>
#include <string>

#include "format/atlas_reader.h"
#include "format/content/grid.h"
#include "format/result.h"
#include "format/tasks/task_control.h"
#include "format/tasks/thread_pool.h"
#include "player/render/clip/cut_faces.h"
#include "player/render/clip/cut_rays.h"
#include "player/render/contributions/pick_structure.h"
#include "player/render/depth_cue/depth_edges.h"
#include "player/render/rays/cast_rays.h"
#include "player/render/rays/march_kernels.h"
#include "player/render/rays/volume/ray_volume.h"
#include "player/render/sheets/sheet_fragments.h"
#include "player/render/sheets/warp/sheet_image.h"
#include "player/render/surfaces/rasterize.h"
#include "player/render/view/view_frame.h"
#include "player/render_options.h"

namespace splatlas {

class Renderer;
struct Frame;

/// Overrides of a renderer's choices, for tests.
struct RenderOverrides {
  bool simd = true;  ///< false: the scalar reference kernels
  /// Principal axis of the shear-warp factorisation, and of rays within kMaxForcedSlope; other rays keep
  /// their best axis. Not set: the best axis of the view, or of each ray.
  std::optional<Axis> principal_axis = std::nullopt;
  bool one_ray = false;  ///< rays: one through the centre of each pixel, however small voxels are
};

/// Access to the state of a renderer, for tests.
struct RendererInternals {
  /// Renderer::render() with overrides. Sheets: also kUsage beyond kMaxForcedSlope of a forced axis.
  [[nodiscard]] static Result<void> render(Renderer& renderer, const Camera& camera,
                                           const RenderOptions& options, const RenderOverrides& overrides,
                                           Frame& frame, const RenderControl& control);
};

/// Rows of a frame whose fragments are kept for picks: many come row by row.
struct PickedRows {
  static constexpr std::int32_t kRows = 64;
  std::uint64_t frame = 0;  ///< its number; 0: none
  std::int32_t first = 0;

  [[nodiscard]] bool holds(std::uint64_t of_frame, std::int32_t row) const {
    return frame == of_frame && row >= first && row < first + kRows;
  }
};

/// Buffers whose memory is reused by the next frame.
struct FrameBuffers {
  Rasterizer rasterizer;
  FragmentList fragments;             ///< of a region of the picture
  PickedRows picked;                  ///< that the fragments are of
  std::vector<float> surface_depths;  ///< by pixel, if rays end at opaque surfaces
  SheetEnds ends;                     ///< the same, by sheet pixel
  FaceLayer faces;                    ///< of a cut; empty: none
  SheetFragments in_sheet;            ///< the fragments, composited with the volume between them
  SheetImage sheet;
  IdImage ids;
  DepthMap depths;
};

/// The volume of a frame by rays.
struct RayScene {
  const RayVolume& volume;
  Grid grid;      ///< of the volume
  int level = 0;  ///< of the grid: voxels, or blocks of 2^level voxels along each axis
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
  std::optional<RayScene> walked = std::nullopt;    ///< for ids and depths of sheets; with walks_rays()
};

/// True if the faces of cuts are drawn.
[[nodiscard]] bool shows_faces(const RenderOptions& options);
/// Bytes of a picture, of its encoder, of its depth map and of its faces.
[[nodiscard]] std::uint64_t frame_bytes(const RenderOptions& options);
/// kLimit if these are more than `max_memory_bytes`.
[[nodiscard]] Result<void> check_size(const RenderOptions& options, std::uint64_t max_memory_bytes);

/// True if rays walk through the volume for ids or depths, whatever draws it.
[[nodiscard]] bool walks_rays(const RenderOptions& options);
/// kUsage if the options ask for ids and the atlas has too many structures for them.
[[nodiscard]] Result<void> check_ids(const RenderOptions& options, const Atlas& atlas);

/// The cut of a frame, for its surfaces.
struct SurfaceCuts {
  std::optional<CutRays> surfaces, of_faces;
  std::optional<ViewFaces> faces;
};

/// Stages of a frame; each adds to its counter and its time in the statistics. A picture with fragments is
/// drawn region by region, so that those of one region take memory.
class FrameRenderer {
 public:
  virtual ~FrameRenderer() = default;

  /// Runs all stages in order. `volume_loops`: loops of render_volume(), for progress.
  [[nodiscard]] Result<void> run(std::size_t volume_loops, TaskControl& task, Picture& picture);

  [[nodiscard]] ShownFrame shown() const;

 protected:
  /// `of_volume`: the grid of the volume's level.
  FrameRenderer(const FrameScene& scene, const Grid& of_volume, FrameBuffers& buffers, RenderStats& stats,
                ThreadPool& pool);

  /// Clips volumes; null without a cut.
  [[nodiscard]] const CutRays* cuts() const { return cuts_ ? &*cuts_ : nullptr; }
  [[nodiscard]] std::span<const VoxelPlane> planes() const {
    return cuts_ ? std::span<const VoxelPlane>(cuts_->planes()) : std::span<const VoxelPlane>();
  }
  [[nodiscard]] MarchKernels kernels() const { return scene_.overrides.simd ? best_march() : scalar_march(); }
  /// Faces of the cut at pixel centres; null without any.
  [[nodiscard]] const FaceLayer* faces() const { return buffers_.faces.empty() ? nullptr : &buffers_.faces; }

  [[nodiscard]] virtual Result<RasterScene> raster_scene_of_view() const = 0;
  /// Prepares the frame's volume, or renders it into the picture, a ray per pixel. kLimit: too large a sheet.
  [[nodiscard]] virtual Result<void> begin_volume(Picture& picture) = 0;
  /// Composites the fragments of a region with the volume between them, and finds the ids asked for.
  [[nodiscard]] virtual Result<void> resolve(const PixelBox& region, Picture& picture) = 0;
  [[nodiscard]] bool needs_depths() const;
  [[nodiscard]] bool paints_surfaces() const;
  [[nodiscard]] bool all_opaque() const;
  /// True if the frame needs no fragments because rays end at opaque surfaces.
  [[nodiscard]] bool ends_at_surfaces() const;
  /// Level of the volume: voxels, or blocks of 2^level voxels along each axis.
  [[nodiscard]] virtual int level() const = 0;
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
  [[nodiscard]] Result<void> begin_surfaces(Picture& picture);
  [[nodiscard]] Result<void> draw_region(const PixelBox& region, Picture& picture);
  [[nodiscard]] auto depth_converter() const;
  void finish_depths(Picture& picture);

  std::optional<CutRays> cuts_;
  SurfaceCuts surface_cuts_;
};

/// Makes the fragments of a pixel of an earlier frame again: with those of the rows around it, if they fit
/// into memory. `number`: of the frame, from 1.
[[nodiscard]] Result<void> rasterize_again(const ShownFrame& frame, std::uint64_t number,
                                           std::span<const SurfaceDraw> surfaces, const Grid& grid,
                                           std::int32_t column, std::int32_t row, FrameBuffers& buffers,
                                           ThreadPool& pool);

/// Clears the numbers of pixels without opacity. Visible ones without a number, at rims where the picture is
/// wider than its rays, get the structure of their densest neighbour, from pixel to pixel.
void fit_ids(const Picture& picture, IdImage& ids);
/// Merges the depths of surfaces into `depths` by minimum. The depth of a sample is that of the fragment at
/// which its transmittance falls to one half; a pixel takes its nearest sample. O(fragments).
void add_surface_depths(const FragmentList& fragments, const ShownFrame& frame, const ViewDepth& view,
                        DepthMap& depths, ThreadPool& pool);

/// The result of body(), the work of a public function, with the exceptions of its task as errors. Errors
/// other than kUsage, which are about options, name the atlas.
template <typename Body>
[[nodiscard]] auto as_errors_of(const std::string& atlas, const Body& body) -> decltype(body()) {
  const auto named = [&](ErrorCode code, const std::string& message) {
    return tl::unexpected(Error{code, atlas + ": " + message, atlas});
  };
  try {
    auto result = body();
    if (result || result.error().code == ErrorCode::kUsage || !result.error().subject.empty()) return result;
    return named(result.error().code, result.error().message);
  } catch (const OverBudget& over) {
    return tl::unexpected(over.error());
  } catch (const Cancelled&) {
    return named(ErrorCode::kCancelled, "rendering was cancelled");
  } catch (const std::bad_alloc&) {
    return named(ErrorCode::kLimit, "out of memory; take a smaller size or select less");
  }
}

}  // namespace splatlas

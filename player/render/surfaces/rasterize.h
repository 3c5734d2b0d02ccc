// Rasteriser of surfaces into an A-buffer, or into a picture.
#pragma once

#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "format/content/selection.h"
#include "format/content/surface.h"
#include "format/tasks/thread_pool.h"
#include "player/picture.h"
#include "player/render/surfaces/fragments.h"
#include "player/render/surfaces/tile_layers.h"
#include "player/render/surfaces/tile_rasterizer.h"

namespace splatlas {

/// A surface with the colour and opacity of a selection; `mesh` and its `clusters` must outlive it.
[[nodiscard]] SurfaceDraw surface_draw(StructureIndex s, const StructureDraw& appearance,
                                       const SurfaceMesh& mesh, const SurfaceClusters& clusters);

struct RasterOptions {
  std::size_t max_fragments = std::numeric_limits<std::size_t>::max();
  /// Fragments behind surfaces of at most this transmittance are omitted.
  float termination_threshold = 0;
  /// Samples of pixels at edges (find_edge_pixels()): 1, 4 or 8.
  std::size_t edge_samples = 1;
};

/// A-buffer rasteriser (Carpenter 1984) in tiles, with a hierarchical depth buffer for opaque surfaces
/// (Greene, Kass and Miller 1993). Triangles cover pixel centres by the top-left rule, which makes closed
/// surfaces watertight. The visible side is shaded (player/render/surfaces/raster_scene.h), and fragments are
/// sorted by pixel and depth. Nothing behind the front-most opaque fragment is kept. Where two surfaces
/// coincide, back faces precede front faces. Degenerate triangles yield no fragments. Edge pixels are then
/// rasterised again with a supersampling pattern. Keeps its memory from frame to frame. Not thread-safe.
class Rasterizer {
 public:
  /// Rasterises all surfaces in the region and returns the number of their triangles; kLimit for more than
  /// `max_fragments`, with the samples of edges. The result is independent of the number of threads. Cost:
  /// linear in vertices, triangles and visible fragments; those at edges count once per sample.
  [[nodiscard]] Result<std::uint64_t> draw(const RasterScene& scene, const RasterOptions& options,
                                           FragmentList& out, ThreadPool& pool);
  /// Draws surfaces in the whole picture, without a volume between them: composites fragments and faces of
  /// each sample, and replaces the picture by the means of the samples. `depths`: for a volume in front of
  /// opaque surfaces, with faces around both: faces are not painted, and it receives the depth of each
  /// pixel's surface or opaque front face, or infinity; null: no volume. The limit is for each tile.
  [[nodiscard]] Result<std::uint64_t> paint(const RasterScene& scene, const RasterOptions& options,
                                            Picture& picture, std::vector<float>* depths, ThreadPool& pool);

 private:
  struct Count;
  using PaintTile = std::function<void(TileRasterizer&)>;

  /// Paints every sample, or keeps its fragments if `paint` is null.
  [[nodiscard]] Result<void> draw_tiles(const RasterScene& scene, const RasterOptions& options,
                                        const PaintTile* paint, ThreadPool& pool);
  /// Draws a tile that `worker` has begun, and paints it or keeps its fragments in `out`.
  void draw_and_finish(std::size_t tile, TileRasterizer& worker, const PaintTile* paint, TileFragments& out,
                       Count& count) const;
  /// Calls visit(pixel, place, fragments) for the samples of a row of tiles, in order of pixels. `drawn`: the
  /// region of the scene, and neighbours.
  template <typename Visit>
  void for_each_sample(std::size_t tile_row, const RasterScene& scene, const PixelBox& drawn,
                       const Visit& visit) const;
  void merge_tiles(const RasterScene& scene, const PixelBox& drawn, FragmentList& out,
                   ThreadPool& pool) const;

  TileBins bins_;
  std::vector<TileFragments> centers_, edges_;  // by tile; edges_ is empty without supersampling
  std::span<const SubPixel> pattern_;           // of edge pixels
  std::vector<SurfacesSeen> seen_;              // by pixel of the region; empty without surfaces
  std::vector<std::uint8_t> is_edge_;           // the same
};

}  // namespace splatlas

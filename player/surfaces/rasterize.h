// Triangles to fragments.
#pragma once

#include <limits>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "format/selection.h"
#include "format/surface.h"
#include "format/system/thread_pool.h"
#include "player/surfaces/band_rasterizer.h"
#include "player/surfaces/fragments.h"
#include "player/surfaces/triangle_bins.h"

namespace splatlas {

/// A surface as a selection draws it; `mesh` must outlive it.
[[nodiscard]] SurfaceDraw surface_draw(StructureIndex s, const StructureDraw& appearance,
                                       const SurfaceMesh& mesh);

struct RasterOptions {
  std::size_t max_fragments = std::numeric_limits<std::size_t>::max();
  /// Fragments behind surfaces that let through no more than this together are left out.
  float termination_threshold = 0;
  /// Of pixels at edges (player/edge_pixels.h): 1, 4 or 8.
  std::size_t edge_samples = 1;
};

struct RasterCounters {
  std::uint64_t triangles = 0;  ///< looked at
};

/// Samples triangles at the pixel centres that they cover (top-left rule: a closed surface covers each centre
/// once per crossing, without cracks), shades the side that is seen (player/facing.h), and sorts the
/// fragments by pixel and depth. Of opaque fragments only the front-most of a pixel is kept, and nothing
/// behind it. Where two surfaces coincide, the one that the ray leaves comes before the one that it enters.
/// Degenerate triangles leave nothing. Pixels at edges are then sampled again, at the points of a pattern,
/// each as the centres are. Keeps its memory from frame to frame.
class Rasterizer {
 public:
  /// kLimit when there would be more than `max_fragments`, samples of edges included. The same fragments with
  /// any number of threads. Cost: vertices, triangles, and the fragments that no opaque surface hides; those
  /// at edges times their samples.
  [[nodiscard]] Result<RasterCounters> draw(const RasterScene& scene, const RasterOptions& options,
                                            FragmentList& out, ThreadPool& pool);

 private:
  /// A fragment list in the making.
  struct Count;

  bool draw_centers(const RasterScene& scene, const RasterOptions& options, Count& count, ThreadPool& pool);
  bool draw_edges(const RasterScene& scene, const RasterOptions& options, Count& count, ThreadPool& pool);
  bool draw_band(std::size_t n, BandRasterizer& band, Count& count) const;
  /// Calls visit(pixel, place, fragments) for the samples of a band's pixels, in order.
  template <typename Visit>
  void for_each_sample(std::size_t band, const RasterScene& scene, const Visit& visit) const;
  void merge_bands(const RasterScene& scene, FragmentList& out, ThreadPool& pool) const;
  [[nodiscard]] std::unique_ptr<BandRasterizer> take_worker();
  void give_back(std::unique_ptr<BandRasterizer> worker);

  /// As many as there are threads.
  struct Workers {
    std::mutex mutex;
    std::vector<std::unique_ptr<BandRasterizer>> idle;
  };

  TriangleBins bins_;
  std::unique_ptr<Workers> workers_ = std::make_unique<Workers>();
  std::vector<BandFragments> centers_, edges_;  // by band; no edges: one sample a pixel
  std::span<const SubPixel> pattern_;           // of edges
  std::vector<SurfacesSeen> seen_;              // of pixels
  std::vector<std::uint8_t> is_edge_;           // of pixels
};

}  // namespace splatlas

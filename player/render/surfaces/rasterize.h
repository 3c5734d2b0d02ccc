// Rasteriser of translucent surfaces into an A-buffer.
#pragma once

#include <limits>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "format/content/selection.h"
#include "format/content/surface.h"
#include "format/tasks/thread_pool.h"
#include "player/render/surfaces/band_rasterizer.h"
#include "player/render/surfaces/fragments.h"
#include "player/render/surfaces/triangle_bins.h"

namespace splatlas {

/// A surface with the colour and opacity of a selection; `mesh` must outlive it.
[[nodiscard]] SurfaceDraw surface_draw(StructureIndex s, const StructureDraw& appearance,
                                       const SurfaceMesh& mesh);

struct RasterOptions {
  std::size_t max_fragments = std::numeric_limits<std::size_t>::max();
  /// Fragments behind surfaces of at most this transmittance are omitted.
  float termination_threshold = 0;
  /// Samples of pixels at edges (player/render/surfaces/edge_pixels.h): 1, 4 or 8.
  std::size_t edge_samples = 1;
};

/// A-buffer rasteriser (Carpenter 1984). Triangles cover pixel centres by the top-left rule, which makes
/// closed surfaces watertight. The visible side is shaded (player/render/surfaces/raster_scene.h), and
/// fragments are sorted by pixel and depth. Nothing behind the front-most opaque fragment is kept. Where two
/// surfaces coincide, back faces precede front faces. Degenerate triangles yield no fragments. Edge pixels
/// are then rasterised again with a supersampling pattern. Keeps its memory from frame to frame. Not
/// thread-safe.
class Rasterizer {
 public:
  /// Rasterises all surfaces and returns the number of their triangles; kLimit for more than `max_fragments`,
  /// with the samples of edges. The result is independent of the number of threads. Cost: linear in vertices,
  /// triangles and visible fragments; those at edges count once per sample.
  [[nodiscard]] Result<std::uint64_t> draw(const RasterScene& scene, const RasterOptions& options,
                                           FragmentList& out, ThreadPool& pool);

 private:
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

  /// Idle band rasterisers, at most one per thread.
  struct Workers {
    std::mutex mutex;
    std::vector<std::unique_ptr<BandRasterizer>> idle;
  };

  TriangleBins bins_;
  std::unique_ptr<Workers> workers_ = std::make_unique<Workers>();
  std::vector<BandFragments> centers_, edges_;  // by band; edges_ is empty without supersampling
  std::span<const SubPixel> pattern_;           // of edge pixels
  std::vector<SurfacesSeen> seen_;              // by pixel
  std::vector<std::uint8_t> is_edge_;           // by pixel
};

}  // namespace splatlas

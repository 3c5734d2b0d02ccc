// Triangles to fragments.
#pragma once

#include <span>

#include "format/selection.h"
#include "format/surface.h"
#include "player/fragments.h"
#include "player/shading.h"
#include "player/shear.h"
#include "player/thread_pool.h"

namespace splatlas {

/// A surface to draw.
struct SurfaceDraw {
  const SurfaceMesh* mesh = nullptr;
  StructureIndex structure = kNoStructure;
  std::array<float, 3> color{1, 1, 1};  ///< linear
  float opacity = 1;                    ///< of each crossing; 1 hides what is behind
};

/// A surface as a selection draws it; `mesh` must outlive it.
[[nodiscard]] SurfaceDraw surface_draw(StructureIndex s, const StructureDraw& look, const SurfaceMesh& mesh);

struct RasterCounters {
  std::uint64_t triangles = 0;  ///< looked at
};

/// Samples every triangle at the pixel centres it covers (top-left rule: a closed surface covers each centre
/// once per crossing, without cracks), shades the side that is seen (player/facing.h), and sorts them by
/// pixel and depth. Of opaque fragments only the front-most of a pixel is kept, and nothing behind it. Where
/// two surfaces coincide, the one that the ray leaves comes before the one that it enters. Degenerate
/// triangles leave nothing. kLimit when there would be more than `max_fragments`.
[[nodiscard]] Result<RasterCounters> rasterize(std::span<const SurfaceDraw> surfaces,
                                               const ParallelView& view, const Shear& shear, const Grid& grid,
                                               const Lighting& lighting, std::size_t max_fragments,
                                               FragmentList& out, ThreadPool& pool);

}  // namespace splatlas

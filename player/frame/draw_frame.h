// From spans and surfaces to a picture: what every frame does once it is known what to draw.
#pragma once

#include <cstdint>
#include <span>

#include "player/frame/stopwatch.h"
#include "player/picture.h"
#include "player/render_options.h"
#include "player/sheets/fragment_order.h"
#include "player/sheets/sheets.h"
#include "player/surfaces/rasterize.h"

namespace splatlas {

/// What one frame draws, and how. Spans are lit.
struct FrameRequest {
  const SpanModel& spans;
  std::span<const SurfaceDraw> surfaces;
  const ParallelView& view;
  const Shear& shear;
  const Grid& grid;
  const Lighting& lighting;
  const RenderOptions& options;
  std::uint64_t max_memory_bytes = 0;  ///< fragments may take a quarter of it
  bool simd = true;                    ///< false: the scalar reference kernels
};

/// Kept from frame to frame, so that their memory is.
struct FrameBuffers {
  Rasterizer rasterizer;
  FragmentList fragments;
  FragmentOrder order;  ///< of the fragments, with the volume in front of them
  SheetImage sheet;
};

struct FrameCounters {
  std::uint64_t voxels = 0;     ///< splatted
  std::uint64_t triangles = 0;  ///< projected
  Elapsed rasterize, sheets, resolve;
};

/// How the rasteriser works at these options; fragments may take a quarter of the memory.
[[nodiscard]] RasterOptions raster_options(const RenderOptions& options, std::uint64_t max_memory_bytes);

/// Rasterises the surfaces, splats and composites the spans sheet by sheet, and resolves both into the
/// picture. kLimit when the fragments or the sheet would be too many.
[[nodiscard]] Result<FrameCounters> draw_frame(const FrameRequest& frame, FrameBuffers& buffers,
                                               Picture& picture, ThreadPool& pool);

}  // namespace splatlas

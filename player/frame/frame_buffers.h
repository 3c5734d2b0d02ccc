// Buffers and counters of a frame.
#pragma once

#include <cstdint>

#include "player/depth_cue/depth_edges.h"
#include "player/render_options.h"
#include "player/sheets/fragment_order.h"
#include "player/sheets/sheets.h"
#include "player/surfaces/rasterize.h"

namespace splatlas {

/// Kept from frame to frame, so that their memory is reused.
struct FrameBuffers {
  Rasterizer rasterizer;
  FragmentList fragments;
  FragmentOrder order;  ///< of the fragments, with the volume in front of them
  SheetImage sheet;
  DepthMap depths;
};

struct FrameCounters {
  std::uint64_t voxels = 0;     ///< splatted, or in the volume that rays march through
  std::uint64_t triangles = 0;  ///< projected
  Elapsed rasterize, sheets, resolve;
};

}  // namespace splatlas

// Buffers and counters of a frame.
#pragma once

#include <cstdint>

#include "player/depth_cue/depth_edges.h"
#include "player/render_options.h"
#include "player/sheets/fragment_order.h"
#include "player/sheets/sheets.h"
#include "player/surfaces/rasterize.h"

namespace splatlas {

/// Buffers whose memory is reused by the next frame.
struct FrameBuffers {
  Rasterizer rasterizer;
  FragmentList fragments;
  FragmentOrder order;  ///< depth order of the fragments, and the volume in front of them
  SheetImage sheet;
  DepthMap depths;
};

/// Counters and times of a frame.
struct FrameCounters {
  std::uint64_t voxels = 0;     ///< splatted voxels, or voxels of the ray volume
  std::uint64_t triangles = 0;  ///< projected triangles
  Elapsed rasterize, sheets, resolve;
};

}  // namespace splatlas

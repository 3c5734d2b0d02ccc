// Depth darkening by unsharp masking of the depth buffer (Luft et al. 2006).
#pragma once

#include "format/tasks/thread_pool.h"
#include "player/picture.h"

namespace splatlas {

/// Parameters of depth darkening.
struct DepthEdges {
  float strength = 0.7f;  ///< 0 (none) to 1 (down to black)
  double radius = 10;     ///< filter radius in pixels
  double range_mm = 10;   ///< depth difference at which darkening saturates
  double min_mm = 0;      ///< depth difference at which darkening begins
};

/// Parameters for shapes of about a fiftieth of the picture, at any zoom.
[[nodiscard]] DepthEdges depth_edges(const ParallelView& plane, float strength);

/// Darkens pixels behind nearby surfaces, by an unsharp mask of the depth buffer (Luft, Colditz and Deussen
/// 2006). Instead of a blurred copy it uses pairs of opposite pixels. The share of a pair is the depth behind
/// the pair's mean, relative to the range and clamped to [0, 1]. Colours are multiplied by
/// 1 - strength * (weighted mean of the shares). Planes remain unchanged at any slant, up to their border. Of
/// a step, only the further side darkens. Concave regions darken, ridges do not. Pairs with background or
/// outside the picture do not count; background, alpha and differences within the rounding error remain
/// unchanged. Cost: 32 pairs per pixel, in parallel. The result is independent of the number of threads.
void darken_edges(const DepthMap& depths, const DepthEdges& edges, Picture& picture, ThreadPool& pool);

}  // namespace splatlas

// Depth-darkened edges: what lies behind something near it in the picture is darker there.
#pragma once

#include <limits>
#include <vector>

#include "format/system/thread_pool.h"
#include "player/picture.h"

namespace splatlas {

/// How far away what a pixel shows is, in mm along the view, from the plane of the centre; top row first.
struct DepthMap {
  static constexpr float kBackground = std::numeric_limits<float>::infinity();
  PictureSize size;
  std::vector<float> mm;

  /// Background all over.
  void clear(const PictureSize& picture_size);
};

struct DepthEdges {
  float strength = 0.7f;  ///< 0: none; 1: down to black; not outside
  double radius = 10;     ///< pixels around
  double range_mm = 10;   ///< so far behind both sides' mean is as dark as it gets
  double min_mm = 0;      ///< so far behind it shows
};

/// For a picture: shapes of about a fiftieth of it, whatever the zoom.
[[nodiscard]] DepthEdges depth_edges(const ParallelView& plane, float strength);

/// An unsharp mask of the depths (Luft, Colditz, Deussen 2006, "Image enhancement by unsharp masking the
/// depth buffer"), from pairs of opposite pixels around each one instead of a blurred copy: of every pair it
/// takes by how much the pixel lies behind the pair's mean, as a share of the range from 0 to 1, and the
/// colour is multiplied by 1 - strength * (mean share, near pairs weigh more). So a plane stays as it is, at
/// any slant and up to its border; of a step only the further side changes; hollows darken, ridges do not.
/// Pairs with background or beyond the picture do not count, background and alpha stay; nor does what the
/// depths' digits cannot tell. Cost: 32 pairs a pixel. The same bits with any number of threads.
void darken_edges(const DepthMap& depths, const DepthEdges& edges, Picture& picture, ThreadPool& pool);

}  // namespace splatlas

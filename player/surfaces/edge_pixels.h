// Which pixels need more than one sample.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "format/system/thread_pool.h"
#include "player/camera.h"
#include "player/surfaces/fragments.h"

namespace splatlas {

/// What a pixel's centre shows of the surfaces, without the volume.
struct SurfacesSeen {
  Light light;
  /// How much each side of each surface shows, summed up with four weights of its own: alike where the same
  /// is seen in the same order, whatever the light on it.
  std::array<float, 4> layers{0, 0, 0, 0};
  float depth = 0;  ///< of the first

  /// The next one, behind surfaces that let `through` pass. `side`: a number for each side of a surface.
  void add(std::uint32_t side, float through, const Fragment& fragment);
};

/// What makes an edge between two neighbours: their light differs by more than kEdgeContrast in any channel,
/// and so do their layers by more than kEdgeLayers or their depths by more than kEdgeSlope pixels.
inline constexpr float kEdgeContrast = 1.0f / 32;
inline constexpr float kEdgeLayers = 1.0f / 16;
inline constexpr float kEdgeSlope = 4;

/// 1 for every pixel at an edge of the surfaces (left, right, above or below of it), else 0: silhouettes,
/// borders and intersections alike, where they show. `pixel_voxels`: of a pixel along the depth axis. Cost:
/// pixels.
void find_edge_pixels(std::span<const SurfacesSeen> seen, const PictureSize& size, float pixel_voxels,
                      std::vector<std::uint8_t>& edges, ThreadPool& pool);

}  // namespace splatlas

// Detection of surface edges for adaptive supersampling.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "format/tasks/thread_pool.h"
#include "player/camera.h"
#include "player/render/surfaces/fragments.h"

namespace splatlas {

/// Summary of the surfaces at a pixel centre, without the volume.
struct SurfacesSeen {
  Radiance radiance;
  /// Signature of the visible layers: contributions of all surface sides, each weighted by its own four hash
  /// values. Pixels with the same layers in the same order have the same signature under any lighting.
  std::array<float, 4> layers{0, 0, 0, 0};
  float depth = 0;  ///< of the first fragment

  /// Adds the next fragment behind surfaces of this transmittance. `side` identifies surface and side.
  void add(std::uint32_t side, float transmittance, const Fragment& fragment);
};

/// Thresholds of an edge between two neighbours. Their radiance must differ by more than kEdgeContrast in any
/// channel. Also, layers must differ by more than kEdgeLayers, or depths by more than kEdgeSlope pixels.
inline constexpr float kEdgeContrast = 1.0f / 32;
inline constexpr float kEdgeLayers = 1.0f / 16;
inline constexpr float kEdgeSlope = 4;

/// Sets `edges` to 1 for every pixel with an edge to one of its four neighbours, else to 0. Edges are visible
/// silhouettes, borders and intersections. `pixel_voxels` is that of RasterScene.
void find_edge_pixels(std::span<const SurfacesSeen> seen, const PictureSize& size, float pixel_voxels,
                      std::vector<std::uint8_t>& edges, ThreadPool& pool);

}  // namespace splatlas

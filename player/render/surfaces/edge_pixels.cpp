#include "player/render/surfaces/edge_pixels.h"

#include <algorithm>
#include <cmath>

namespace splatlas {
namespace {

constexpr std::size_t kRowsPerChunk = 16;

float max_difference(const std::array<float, 4>& a, const std::array<float, 4>& b) {
  float max = 0;
  for (std::size_t c = 0; c < 4; ++c) max = std::max(max, std::abs(a[c] - b[c]));
  return max;
}

}  // namespace

void SurfacesSeen::add(std::uint32_t side, float transmittance, const Fragment& fragment) {
  constexpr std::uint32_t kHashFactor = 0x9e3779b1;  // 2^32 over the golden ratio
  if (radiance.rgba[3] == 0) depth = fragment.depth;
  const std::uint32_t hash = (side + 1) * kHashFactor;
  const float share = transmittance * fragment.rgba[3];
  for (std::size_t c = 0; c < 4; ++c) {
    radiance.rgba[c] += transmittance * fragment.rgba[c];
    layers[c] += share * static_cast<float>((hash >> (8 * c)) & 0xff) * (1.0f / 255);
  }
}

void find_edge_pixels(std::span<const SurfacesSeen> seen, const PictureSize& size, float pixel_voxels,
                      std::vector<std::uint8_t>& edges, ThreadPool& pool) {
  const auto edge_between = [max_depth = kEdgeSlope * pixel_voxels](const SurfacesSeen& a,
                                                                    const SurfacesSeen& b) {
    const bool differ =
        max_difference(a.layers, b.layers) > kEdgeLayers || std::abs(a.depth - b.depth) > max_depth;
    return differ && max_difference(a.radiance.rgba, b.radiance.rgba) > kEdgeContrast;
  };
  const auto width = static_cast<std::size_t>(size.width);
  const auto height = static_cast<std::size_t>(size.height);
  edges.assign(width * height, 0);
  pool.for_each((height + kRowsPerChunk - 1) / kRowsPerChunk, [&](std::size_t chunk) {
    const std::size_t first = chunk * kRowsPerChunk;
    for (std::size_t row = first; row < std::min(first + kRowsPerChunk, height); ++row) {
      const SurfacesSeen* here = &seen[row * width];
      std::uint8_t* const edge = &edges[row * width];
      for (std::size_t x = 1; x < width; ++x) {
        if (edge_between(here[x - 1], here[x])) edge[x - 1] = edge[x] = 1;
      }
      // Test both vertical neighbours, so that a chunk writes only to its own rows
      const SurfacesSeen* const above = row > 0 ? here - width : nullptr;
      const SurfacesSeen* const below = row + 1 < height ? here + width : nullptr;
      for (std::size_t x = 0; x < width; ++x) {
        if (above != nullptr && edge_between(here[x], above[x])) edge[x] = 1;
        if (below != nullptr && edge_between(here[x], below[x])) edge[x] = 1;
      }
    }
  });
}

}  // namespace splatlas

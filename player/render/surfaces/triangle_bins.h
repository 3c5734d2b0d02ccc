// Rasteriser bins: snapped vertices, and the triangles of each band of picture rows.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "format/content/structure_graph.h"
#include "format/content/surface.h"
#include "format/tasks/thread_pool.h"
#include "player/render/clip/cut_rays.h"
#include "player/render/surfaces/clip_triangle.h"
#include "player/render/view/sample_pattern.h"
#include "player/render/view/view_frame.h"

namespace splatlas {

/// A surface with its material.
struct SurfaceDraw {
  const SurfaceMesh* mesh = nullptr;
  StructureIndex structure = kNoStructure;
  std::array<float, 3> color{1, 1, 1};  ///< linear
  float opacity = 1;                    ///< of each crossing
};

/// A vertex snapped to 1/256 pixel, so that edge functions are exact integers. Pixel centres are at multiples
/// of 256.
struct ScreenVertex {
  static constexpr std::int32_t kOff = std::numeric_limits<std::int32_t>::min();
  std::int32_t x = kOff, y = kOff;

  /// False for vertices outside the near plane or the guard band (player/render/surfaces/clip_triangle.h).
  [[nodiscard]] bool is_on() const { return x != kOff; }
};
[[nodiscard]] ScreenVertex snapped(const ScreenPoint& point);

/// Bounding box of pixels, with both ends included.
struct PixelBox {
  std::int32_t x_first = 0, x_last = -1, y_first = 0, y_last = -1;
};

[[nodiscard]] inline PixelBox intersection(const PixelBox& a, const PixelBox& b) {
  return {std::max(a.x_first, b.x_first), std::min(a.x_last, b.x_last), std::max(a.y_first, b.y_first),
          std::min(a.y_last, b.y_last)};
}

/// Pixels with centres in the bounding box of a triangle, padded by `reach` (1/256 pixel).
[[nodiscard]] inline PixelBox pixels_of(const ScreenVertex& a, const ScreenVertex& b, const ScreenVertex& c,
                                        std::int32_t reach) {
  constexpr std::int32_t kUp = (1 << kSubPixelBits) - 1;
  const std::int32_t x_low = std::min(std::min(a.x, b.x), c.x) - reach;
  const std::int32_t x_high = std::max(std::max(a.x, b.x), c.x) + reach;
  const std::int32_t y_low = std::min(std::min(a.y, b.y), c.y) - reach;
  const std::int32_t y_high = std::max(std::max(a.y, b.y), c.y) + reach;
  return {(x_low + kUp) >> kSubPixelBits, x_high >> kSubPixelBits, (y_low + kUp) >> kSubPixelBits,
          y_high >> kSubPixelBits};
}

/// A triangle of a surface, or a clipped part of it.
struct TriangleRef {
  std::uint32_t surface = 0, triangle = 0;
  const ClippedTriangle* part = nullptr;  ///< null if the triangle is not clipped
};

/// Bins of triangles by band of picture rows. Keeps its memory from frame to frame.
class TriangleBins {
 public:
  static constexpr int kBandRows = 8;  ///< the crossings of a band fit the L2 cache

  /// Projects every vertex once. Sorts each triangle into the bands of the pixel centres in its bounding box.
  /// Surfaces and their triangles stay in order within a band. Omits triangles that one plane of `cuts`
  /// removes; null: no cut.
  void fill(std::span<const SurfaceDraw> surfaces, const Projection& projection, const PictureSize& size,
            const CutRays* cuts, ThreadPool& pool);

  /// Replaces the bins by the triangles that may overlap a wanted pixel at any of its points. `wanted` has a
  /// flag for every pixel of the picture.
  void refill(std::span<const std::uint8_t> wanted, const PictureSize& size, ThreadPool& pool);

  [[nodiscard]] std::size_t bands() const { return bands_; }
  [[nodiscard]] std::span<const ScreenVertex> vertices(std::size_t surface) const {
    return std::span(vertices_).subspan(first_vertex_[surface]);
  }
  /// True if a plane of the cut removes at least one corner of a triangle.
  [[nodiscard]] bool meets_cut(std::size_t surface, const std::array<std::uint32_t, 3>& corners) const {
    if (removing_.empty()) return false;
    const std::uint8_t* of = removing_.data() + first_vertex_[surface];
    return (of[corners[0]] | of[corners[1]] | of[corners[2]]) != 0;
  }
  /// Calls visit(TriangleRef) for the triangles of a band, those of opaque surfaces or the others.
  template <typename Visit>
  void for_each(std::size_t band, bool opaque, const Visit& visit) const {
    for (const Chunk& chunk : chunks_) {
      if (chunk.opaque != opaque) continue;
      const std::vector<std::uint32_t>& triangles = chunk.of_band[band];
      for (std::size_t n = 0; n < triangles.size(); ++n) {
        if (n + 2 * kAhead < triangles.size()) {
          prefetch(chunk, triangles[n + kAhead], triangles[n + 2 * kAhead]);
        }
        visit(TriangleRef{chunk.surface, triangles[n]});
      }
      for (const std::uint32_t n : chunk.parts_of_band[band]) {
        visit(TriangleRef{chunk.surface, chunk.parts[n].triangle, &chunk.parts[n]});
      }
    }
  }

 private:
  /// A range of triangles of a surface.
  struct Chunk {
    std::uint32_t surface = 0;
    std::uint32_t first = 0, last = 0;
    bool opaque = false;
    const SurfaceMesh* mesh = nullptr;
    std::vector<std::vector<std::uint32_t>> of_band;
    std::vector<ClippedTriangle> parts;  ///< of clipped triangles
    std::vector<std::vector<std::uint32_t>> parts_of_band;
  };

  /// Prefetch distance: a band's triangles of a chunk are scattered in memory.
  static constexpr std::size_t kAhead = 8;
  void prefetch(const Chunk& chunk, std::uint32_t soon, std::uint32_t later) const {
    __builtin_prefetch(&chunk.mesh->triangles[later]);
    const std::uint32_t corner = chunk.mesh->triangles[soon][0];
    __builtin_prefetch(&vertices_[first_vertex_[chunk.surface] + corner]);
    __builtin_prefetch(&chunk.mesh->positions_ijk[corner]);
    __builtin_prefetch(&chunk.mesh->normals_lps[corner]);
  }

  /// True if one plane removes all corners.
  [[nodiscard]] bool is_removed(const Chunk& chunk, std::uint32_t triangle) const {
    if (removing_.empty()) return false;
    const auto& [a, b, c] = chunk.mesh->triangles[triangle];
    const std::uint8_t* of = removing_.data() + first_vertex_[chunk.surface];
    return (of[a] & of[b] & of[c]) != 0;
  }
  void list_chunks(std::span<const SurfaceDraw> surfaces);
  void clip_chunk(Chunk& chunk, const Projection& projection) const;
  template <typename IsWanted>
  void fill_chunk(Chunk& chunk, const PictureSize& size, std::int32_t reach, const IsWanted& is_wanted) const;

  std::size_t bands_ = 0;
  std::vector<std::size_t> first_vertex_;  // of each surface
  std::vector<ScreenVertex> vertices_;
  std::vector<std::uint8_t> removing_;  // CutRays::removing() of vertices_; empty without a cut
  std::vector<Chunk> chunks_;
};

}  // namespace splatlas

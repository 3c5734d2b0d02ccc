// Vertices on the screen, and which triangles reach which part of it.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "format/structure_graph.h"
#include "format/surface.h"
#include "player/projection.h"
#include "player/sample_pattern.h"
#include "player/thread_pool.h"

namespace splatlas {

/// A surface to draw.
struct SurfaceDraw {
  const SurfaceMesh* mesh = nullptr;
  StructureIndex structure = kNoStructure;
  std::array<float, 3> color{1, 1, 1};  ///< linear
  float opacity = 1;                    ///< of each crossing; 1 hides what is behind
};

/// A vertex at the nearest 1/256 pixel; pixel centres are at multiples of 256. Edge functions of such are
/// exact integers.
struct ScreenVertex {
  static constexpr std::int32_t kOff = std::numeric_limits<std::int32_t>::min();
  std::int32_t x = kOff, y = kOff;

  /// False for vertices behind the eye or too far beside the picture.
  [[nodiscard]] bool is_on() const { return x != kOff; }
};

/// Pixel numbers whose centres lie within [low, high] (1/256 pixel).
[[nodiscard]] inline std::int32_t first_pixel(std::int32_t low) {
  return (low + (1 << kSubPixelBits) - 1) >> kSubPixelBits;
}
[[nodiscard]] inline std::int32_t last_pixel(std::int32_t high) {
  return high >> kSubPixelBits;
}

struct TriangleRef {
  std::uint32_t surface = 0, triangle = 0;
};

/// The triangles of a picture by bands of its rows. Keeps its memory from frame to frame.
class TriangleBins {
 public:
  static constexpr int kBandRows = 16;

  /// Projects every vertex once, and sorts the triangles that reach a pixel centre into the bands that they
  /// reach. Surfaces and their triangles stay in order within a band.
  void fill(std::span<const SurfaceDraw> surfaces, const Projection& projection, const PictureSize& size,
            ThreadPool& pool);

  [[nodiscard]] std::size_t bands() const { return bands_; }
  [[nodiscard]] std::span<const ScreenVertex> vertices(std::size_t surface) const {
    return std::span(vertices_).subspan(first_vertex_[surface]);
  }
  /// Calls visit(TriangleRef) for the triangles of a band, those of opaque surfaces or the others.
  template <typename Visit>
  void for_each(std::size_t band, bool opaque, const Visit& visit) const {
    for (const Chunk& chunk : chunks_) {
      if (chunk.opaque != opaque) continue;
      for (const std::uint32_t triangle : chunk.of_band[band]) visit(TriangleRef{chunk.surface, triangle});
    }
  }

 private:
  /// Some of the triangles of a surface.
  struct Chunk {
    std::uint32_t surface = 0;
    std::uint32_t first = 0, last = 0;
    bool opaque = false;
    std::vector<std::vector<std::uint32_t>> of_band;
  };

  void list_chunks(std::span<const SurfaceDraw> surfaces);
  void fill_chunk(Chunk& chunk, const SurfaceMesh& mesh, const PictureSize& size) const;

  std::size_t bands_ = 0;
  std::vector<std::size_t> first_vertex_;  // of each surface
  std::vector<ScreenVertex> vertices_;
  std::vector<Chunk> chunks_;
};

}  // namespace splatlas

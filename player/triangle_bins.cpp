#include "player/triangle_bins.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace splatlas {
namespace {

constexpr double kSubPixels = 1 << kSubPixelBits;
/// Pixels beside the picture: numbers then fit 29 bits, and edge functions 64.
constexpr double kGuardBand = double{1 << 20};
constexpr std::size_t kTrianglesPerChunk = 4096;
constexpr std::size_t kVerticesPerChunk = 16384;

/// To the nearest multiple of 1/256 (halfway: the even one), |value| < kGuardBand.
std::int32_t snapped(double value) {
  constexpr double kRounder = 0x1.8p52;  // doubles around it are whole numbers, their lowest bits count up
  return static_cast<std::int32_t>(std::bit_cast<std::int64_t>(value * kSubPixels + kRounder));
}

ScreenVertex screen_vertex(const Projection& projection, const std::array<float, 3>& position) {
  constexpr double kNearest = 1e-4;  // of the distance between eye and centre
  const ScreenPoint point = projection.on_screen(position);
  const bool on = point.w >= kNearest && std::abs(point.x) < kGuardBand && std::abs(point.y) < kGuardBand;
  return on ? ScreenVertex{snapped(point.x), snapped(point.y)} : ScreenVertex{};
}

}  // namespace

void TriangleBins::fill(std::span<const SurfaceDraw> surfaces, const Projection& projection,
                        const PictureSize& size, ThreadPool& pool) {
  bands_ = (static_cast<std::size_t>(size.height) + kBandRows - 1) / kBandRows;
  list_chunks(surfaces);

  struct VertexChunk {
    std::size_t surface = 0, first = 0, last = 0;
  };
  std::vector<VertexChunk> vertex_chunks;
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    const std::size_t vertices = surfaces[s].mesh->positions_ijk.size();
    for (std::size_t first = 0; first < vertices; first += kVerticesPerChunk) {
      vertex_chunks.push_back({s, first, std::min(first + kVerticesPerChunk, vertices)});
    }
  }
  pool.for_each(vertex_chunks.size(), [&](std::size_t n) {
    const VertexChunk& chunk = vertex_chunks[n];
    const auto& positions = surfaces[chunk.surface].mesh->positions_ijk;
    ScreenVertex* out = vertices_.data() + first_vertex_[chunk.surface];
    for (std::size_t v = chunk.first; v < chunk.last; ++v) out[v] = screen_vertex(projection, positions[v]);
  });
  pool.for_each(chunks_.size(),
                [&](std::size_t n) { fill_chunk(chunks_[n], *surfaces[chunks_[n].surface].mesh, size); });
}

/// Chunks do not depend on the number of threads.
void TriangleBins::list_chunks(std::span<const SurfaceDraw> surfaces) {
  first_vertex_.clear();
  std::size_t vertices = 0;
  std::size_t chunks = 0;
  for (std::uint32_t s = 0; s < surfaces.size(); ++s) {
    first_vertex_.push_back(vertices);
    vertices += surfaces[s].mesh->positions_ijk.size();
    const std::size_t triangles = surfaces[s].mesh->triangles.size();
    for (std::size_t first = 0; first < triangles; first += kTrianglesPerChunk) {
      if (chunks == chunks_.size()) chunks_.emplace_back();
      Chunk& chunk = chunks_[chunks++];
      chunk.surface = s;
      chunk.first = static_cast<std::uint32_t>(first);
      chunk.last = static_cast<std::uint32_t>(std::min(first + kTrianglesPerChunk, triangles));
      chunk.opaque = surfaces[s].opacity >= 1;
    }
  }
  chunks_.resize(chunks);
  vertices_.resize(vertices);
}

void TriangleBins::fill_chunk(Chunk& chunk, const SurfaceMesh& mesh, const PictureSize& size) const {
  chunk.of_band.resize(bands_);
  for (std::vector<std::uint32_t>& band : chunk.of_band) band.clear();
  const std::span<const ScreenVertex> vertices = this->vertices(chunk.surface);
  for (std::uint32_t t = chunk.first; t < chunk.last; ++t) {
    const auto& corner = mesh.triangles[t];
    const ScreenVertex a = vertices[corner[0]];
    const ScreenVertex b = vertices[corner[1]];
    const ScreenVertex c = vertices[corner[2]];
    if (!a.is_on() || !b.is_on() || !c.is_on()) continue;
    const auto [x_low, x_high] = std::minmax({a.x, b.x, c.x});
    const auto [y_low, y_high] = std::minmax({a.y, b.y, c.y});
    const std::int32_t y_first = std::max(0, first_pixel(y_low));
    const std::int32_t y_last = std::min(size.height - 1, last_pixel(y_high));
    if (std::max(0, first_pixel(x_low)) > std::min(size.width - 1, last_pixel(x_high))) continue;
    if (y_first > y_last) continue;
    for (std::int32_t band = y_first / kBandRows; band <= y_last / kBandRows; ++band) {
      chunk.of_band[static_cast<std::size_t>(band)].push_back(t);
    }
  }
}

}  // namespace splatlas

#include "player/render/surfaces/triangle_bins.h"

#include <bit>
#include <cmath>

namespace splatlas {
namespace {

constexpr std::size_t kTrianglesPerChunk = 4096;
/// Larger bounding boxes are not searched for wanted pixels.
constexpr std::int64_t kFewPixels = 64;
constexpr std::size_t kVerticesPerChunk = 16384;

/// Rounds to the nearest multiple of 1/256, ties to even, for |value| < kGuardBand.
std::int32_t snapped(double value) {
  constexpr double kRounder = 0x1.8p52;  // doubles around it are consecutive integers
  return static_cast<std::int32_t>(std::bit_cast<std::int64_t>(value * kSubPixels + kRounder));
}

}  // namespace

ScreenVertex snapped(const ScreenPoint& point) {
  const bool on = point.w >= kNearPlane && std::abs(point.x) < kGuardBand && std::abs(point.y) < kGuardBand;
  return on ? ScreenVertex{snapped(point.x), snapped(point.y)} : ScreenVertex{};
}

void TriangleBins::fill(std::span<const SurfaceDraw> surfaces, const Projection& projection,
                        const PictureSize& size, const CutRays* cuts, ThreadPool& pool) {
  // Split vertices into chunks
  bands_ = (static_cast<std::size_t>(size.height) + kBandRows - 1) / kBandRows;
  list_chunks(surfaces);
  removing_.resize(cuts != nullptr ? vertices_.size() : 0);

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

  // Project and snap vertices
  pool.for_each(vertex_chunks.size(), [&](std::size_t n) {
    const VertexChunk& chunk = vertex_chunks[n];
    const auto& positions = surfaces[chunk.surface].mesh->positions_ijk;
    ScreenVertex* out = vertices_.data() + first_vertex_[chunk.surface];
    for (std::size_t v = chunk.first; v < chunk.last; ++v) {
      out[v] = snapped(projection.on_screen(positions[v]));
    }
    if (cuts == nullptr) return;
    std::uint8_t* removing = removing_.data() + first_vertex_[chunk.surface];
    for (std::size_t v = chunk.first; v < chunk.last; ++v) removing[v] = cuts->removing(positions[v]);
  });

  // Clip triangles and sort them into bins
  pool.for_each(chunks_.size(), [&](std::size_t n) {
    clip_chunk(chunks_[n], projection);
    fill_chunk(chunks_[n], size, 0, [](const PixelBox&) { return true; });
  });
}

void TriangleBins::refill(std::span<const std::uint8_t> wanted, const PictureSize& size, ThreadPool& pool) {
  const auto any_in = [&](const PixelBox& box) {
    if (std::int64_t{box.x_last - box.x_first} * (box.y_last - box.y_first) > kFewPixels) return true;
    for (std::int32_t y = box.y_first; y <= box.y_last; ++y) {
      const std::uint8_t* row = wanted.data() + std::ptrdiff_t{y} * size.width;
      if (std::find_if(row + box.x_first, row + box.x_last + 1, [](std::uint8_t w) { return w != 0; }) !=
          row + box.x_last + 1) {
        return true;
      }
    }
    return false;
  };
  pool.for_each(chunks_.size(),
                [&](std::size_t n) { fill_chunk(chunks_[n], size, 1 << (kSubPixelBits - 1), any_in); });
}

/// Chunks are independent of the number of threads.
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
      chunk.mesh = surfaces[s].mesh;
      chunk.first = static_cast<std::uint32_t>(first);
      chunk.last = static_cast<std::uint32_t>(std::min(first + kTrianglesPerChunk, triangles));
      chunk.opaque = surfaces[s].opacity >= 1;
    }
  }
  chunks_.resize(chunks);
  vertices_.resize(vertices);
}

void TriangleBins::clip_chunk(Chunk& chunk, const Projection& projection) const {
  const std::span<const ScreenVertex> vertices = this->vertices(chunk.surface);
  chunk.parts.clear();
  for (std::uint32_t t = chunk.first; t < chunk.last; ++t) {
    const auto& [a, b, c] = chunk.mesh->triangles[t];
    if (is_removed(chunk, t)) continue;
    if (vertices[a].is_on() && vertices[b].is_on() && vertices[c].is_on()) continue;
    clip_triangle(*chunk.mesh, t, projection, chunk.parts);
  }
}

template <typename IsWanted>
void TriangleBins::fill_chunk(Chunk& chunk, const PictureSize& size, std::int32_t reach,
                              const IsWanted& is_wanted) const {
  using Bins = std::vector<std::vector<std::uint32_t>>;
  for (Bins* bins : {&chunk.of_band, &chunk.parts_of_band}) {
    bins->resize(bands_);
    for (std::vector<std::uint32_t>& band : *bins) band.clear();
  }
  const auto sort_in = [&](PixelBox box, std::uint32_t number, Bins& bins) {
    box = intersection(box, {0, size.width - 1, 0, size.height - 1});
    if (box.x_first > box.x_last || box.y_first > box.y_last || !is_wanted(box)) return;
    for (std::int32_t band = box.y_first / kBandRows; band <= box.y_last / kBandRows; ++band) {
      bins[static_cast<std::size_t>(band)].push_back(number);
    }
  };
  const std::span<const ScreenVertex> vertices = this->vertices(chunk.surface);
  for (std::uint32_t t = chunk.first; t < chunk.last; ++t) {
    const auto& corner = chunk.mesh->triangles[t];
    const ScreenVertex a = vertices[corner[0]];
    const ScreenVertex b = vertices[corner[1]];
    const ScreenVertex c = vertices[corner[2]];
    if (!a.is_on() || !b.is_on() || !c.is_on() || is_removed(chunk, t)) continue;
    sort_in(pixels_of(a, b, c, reach), t, chunk.of_band);
  }
  for (std::uint32_t n = 0; n < chunk.parts.size(); ++n) {
    const auto& [a, b, c] = chunk.parts[n].corner;
    sort_in(pixels_of(snapped(a), snapped(b), snapped(c), reach), n, chunk.parts_of_band);
  }
}

}  // namespace splatlas

#include "player/render/surfaces/tile_rasterizer.h"

#include <algorithm>

namespace splatlas {
namespace {

/// Surfaces coincide if their depths lie in the same bin of 1/4096 voxel. The offset moves bin limits away
/// from common surface depths such as half voxels, where rounding would decide.
constexpr double kDepthSteps = 4096;
constexpr double kDepthOffset = 0.3183;
constexpr std::int64_t kDepthBias =
    std::int64_t{1} << 40;  // bins; exceeds the depth of any grid, so that all bins are positive

/// Number of the bin of a depth.
std::uint64_t bin_of(double depth) {
  const double steps = depth * kDepthSteps + kDepthOffset;
  const auto whole = static_cast<std::int64_t>(steps);  // std::floor() is slow before SSE4.1
  return static_cast<std::uint64_t>(whole - (static_cast<double>(whole) > steps ? 1 : 0) + kDepthBias);
}

/// Depths behind this one are behind an opaque crossing by more than the width of a bin and rounding.
float hiding(float depth) {
  constexpr float kSurelyBehind = 2 / 4096.0f, kRounding = 0x1p-22f;
  return depth + kSurelyBehind + std::abs(depth) * kRounding;
}

}  // namespace

void TileRasterizer::begin(const RasterScene& scene, const PixelBox& tile) {
  scene_ = &scene;
  tile_ = tile;
  slot_of_pixel_.clear();
  pixel_hiding_.clear();
  pattern_ = kCentre;
  clear(std::size_t{kStride} * kStride);
  // Nothing is seen outside the picture
  const auto columns = static_cast<std::uint32_t>(tile.x_last - tile.x_first + 1);
  const auto rows = static_cast<std::uint32_t>(tile.y_last - tile.y_first + 1);
  for (std::uint32_t y = 0; y < kStride; ++y) {
    const auto row = hiding_.begin() + std::ptrdiff_t{y} * kStride;
    std::fill(row + (y < rows ? columns : 0), row + kStride, -kNothingHidden);
  }
  if (scene.faces != nullptr) hide_behind_faces(columns, rows);
}

/// Nothing is seen behind opaque faces.
void TileRasterizer::hide_behind_faces(std::uint32_t columns, std::uint32_t rows) {
  const auto width = static_cast<std::size_t>(scene_->size.width);
  for (std::uint32_t y = 0; y < rows; ++y) {
    const std::size_t first =
        (static_cast<std::size_t>(tile_.y_first) + y) * width + static_cast<std::size_t>(tile_.x_first);
    for (std::uint32_t x = 0; x < columns; ++x) {
      if (scene_->faces->hides(first + x)) hiding_[std::size_t{y} * kStride + x] = -kNothingHidden;
    }
  }
  for (std::uint32_t block = 0; block < block_hiding_.size(); ++block) renew_block(block);
}

void TileRasterizer::begin_edges(const RasterScene& scene, const PixelBox& tile,
                                 std::span<const std::uint8_t> wanted, std::span<const SubPixel> pattern) {
  scene_ = &scene;
  tile_ = tile;
  pattern_ = pattern;
  slot_of_pixel_.assign(std::size_t{kStride} * kStride, kNone);
  pixel_hiding_.assign(std::size_t{kStride} * kStride, -kNothingHidden);
  std::uint32_t slots = 0;
  for (std::int32_t y = tile.y_first; y <= tile.y_last; ++y) {
    const std::size_t row = static_cast<std::size_t>(y) * static_cast<std::size_t>(scene.size.width);
    for (std::int32_t x = tile.x_first; x <= tile.x_last; ++x) {
      if (wanted[row + static_cast<std::size_t>(x)] == 0) continue;
      const auto pixel =
          static_cast<std::size_t>((y - tile.y_first) * TileBins::kTileSide + x - tile.x_first);
      slot_of_pixel_[pixel] = slots;
      pixel_hiding_[pixel] = kNothingHidden;
      slots += static_cast<std::uint32_t>(pattern.size());
    }
  }
  clear(slots);
  for (std::uint32_t block = 0; block < block_hiding_.size(); ++block) renew_block(block);
}

void TileRasterizer::clear(std::size_t slots) {
  hiding_.assign(slots, kNothingHidden);
  nearest_.resize(slots);
  block_hiding_.fill(kNothingHidden);
  crossings_.clear();
}

void TileRasterizer::draw(const TileCluster& of) {
  if (is_hidden(of)) return;
  const SurfaceDraw& surface = scene_->surfaces[of.surface];
  const SurfaceClusters::Cluster cluster = (*surface.clusters)[of.cluster];
  place_vertices(cluster, of.is_cut);
  changed_ = false;
  Current current;
  current.surface = of.surface;
  current.is_opaque = surface.is_opaque();
  current.hides_back = current.is_opaque && surface.clusters->is_closed() && scene_->cuts == nullptr &&
                       scene_->projection.is_parallel();
  for (std::size_t n = 0; n < cluster.triangles.size(); ++n) {
    const SurfaceClusters::Triangle& triangle = cluster.triangles[n];
    const Vertex& a = vertices_[triangle.corners[0]];
    const Vertex& b = vertices_[triangle.corners[1]];
    const Vertex& c = vertices_[triangle.corners[2]];
    if ((a.removing & b.removing & c.removing) != 0) continue;
    current.triangle = cluster.first + static_cast<std::uint32_t>(n);
    current.front = triangle.front;
    current.cuts = (a.removing | b.removing | c.removing) != 0 ? scene_->cuts : nullptr;
    current.nearest = std::min({a.depth, b.depth, c.depth});
    current.depths = {a.depth, b.depth, c.depth};
    current.points = {a.point, b.point, c.point};
    if (a.snapped.is_on() && b.snapped.is_on() && c.snapped.is_on()) {
      draw_triangle({a.snapped, b.snapped, c.snapped}, current);
    } else {
      draw_parts(current);
    }
  }
  if (!changed_) return;
  for (std::uint32_t y = of.y_first; y <= of.y_last; ++y) {
    for (std::uint32_t x = of.x_first; x <= of.x_last; ++x) renew_block(y * kBlocks + x);
  }
}

/// True if every sample in the blocks of a cluster is behind an opaque surface.
bool TileRasterizer::is_hidden(const TileCluster& of) const {
  for (std::uint32_t y = of.y_first; y <= of.y_last; ++y) {
    for (std::uint32_t x = of.x_first; x <= of.x_last; ++x) {
      if (of.nearest <= block_hiding_[y * kBlocks + x]) return false;
    }
  }
  return true;
}

/// The same for the triangle of a small box.
bool TileRasterizer::is_hidden(const PixelBox& box, float nearest) const {
  constexpr std::int32_t kSmall = 8;
  if (box.x_last - box.x_first >= kSmall || box.y_last - box.y_first >= kSmall) return false;
  for (std::int32_t y = box.y_first; y <= box.y_last; ++y) {
    const float* const row =
        hiding_of_pixels() + std::ptrdiff_t{y - tile_.y_first} * TileBins::kTileSide - tile_.x_first;
    for (std::int32_t x = box.x_first; x <= box.x_last; ++x) {
      if (nearest <= row[x]) return false;
    }
  }
  return true;
}

void TileRasterizer::renew_pixel(std::uint32_t pixel) {
  const auto first = hiding_.begin() + slot_of_pixel_[pixel];
  pixel_hiding_[pixel] = *std::max_element(first, first + static_cast<std::ptrdiff_t>(pattern_.size()));
}

void TileRasterizer::renew_block(std::uint32_t block) {
  constexpr std::uint32_t kSide = TileBins::kBlockSide;
  const std::size_t first =
      std::size_t{block} / kBlocks * kSide * kStride + std::size_t{block} % kBlocks * kSide;
  const float* row = hiding_of_pixels() + first;
  std::array<float, kSide> furthest;  // of columns, for vector instructions
  std::copy_n(row, kSide, furthest.begin());
  for (std::uint32_t y = 1; y < kSide; ++y) {
    row += kStride;
    for (std::uint32_t x = 0; x < kSide; ++x) furthest[x] = furthest[x] > row[x] ? furthest[x] : row[x];
  }
  block_hiding_[block] = *std::ranges::max_element(furthest);
}

void TileRasterizer::place_vertices(const SurfaceClusters::Cluster& cluster, bool is_cut) {
  vertices_.resize(cluster.positions_ijk.size());
  const auto sign = static_cast<float>(scene_->depth_sign);
  for (std::size_t n = 0; n < vertices_.size(); ++n) {
    const std::array<float, 3>& position = cluster.positions_ijk[n];
    Vertex& vertex = vertices_[n];
    vertex.point = scene_->projection.on_screen(position);
    vertex.snapped = snapped(vertex.point);
    vertex.depth = sign * position[scene_->depth_axis];
    vertex.removing = is_cut ? scene_->cuts->removing(position) : 0;
  }
}

/// Draws the parts of a triangle within the near plane and the guard band.
void TileRasterizer::draw_parts(Current& current) {
  parts_.clear();
  const SurfaceDraw& surface = scene_->surfaces[current.surface];
  clip_triangle(*surface.mesh, surface.clusters->number(current.triangle), scene_->projection, parts_);
  const std::array<double, 3> of_triangle = current.depths;
  for (const ClippedTriangle& part : parts_) {
    current.part = &part;
    current.points = part.corner;
    for (std::size_t n = 0; n < 3; ++n) current.depths[n] = dot(part.weights[n], of_triangle);
    draw_triangle({snapped(part.corner[0]), snapped(part.corner[1]), snapped(part.corner[2])}, current);
  }
  current.part = nullptr;
}

void TileRasterizer::draw_triangle(const std::array<ScreenVertex, 3>& corners, Current& current) {
  const std::int64_t area = doubled_area(corners[0], corners[1], corners[2]);
  if (area == 0 || (area > 0 && current.hides_back)) return;
  const bool at_centers = slot_of_pixel_.empty();
  const PixelBox box =
      intersection(pixels_of(corners[0], corners[1], corners[2], at_centers ? 0 : kHalfPixel), tile_);
  if (box.empty() || is_hidden(box, current.nearest)) return;
  const ScreenTriangle t(corners, area);
  current.attributes.reset();
  if (at_centers) {
    sample_centers(t, box, current);
  } else {
    sample_patterns(t, box, current);
  }
}

/// Inlined into both loops over samples: a call costs as much as a hidden sample.
inline __attribute__((always_inline)) void TileRasterizer::hit(const ScreenTriangle& t,
                                                               const EdgeWalk::Edges& edges, double x,
                                                               double y, std::uint32_t slot,
                                                               Current& current) {
  // Find the depth, unless the triangle is hidden
  if (current.nearest > hiding_[slot]) return;
  if (!current.attributes)
    current.attributes.emplace(current.points, current.depths, scene_->projection.is_parallel(),
                               current.part);
  const TriangleAttributes& attributes = *current.attributes;
  const double depth = attributes.depth_at(x, y);
  if (static_cast<float>(depth) > hiding_[slot]) return;
  if (current.cuts != nullptr) {
    const ClipDepths kept = current.cuts->depths(x + 0.5, y + 0.5, scene_->depth_axis, scene_->depth_sign);
    if (!(depth >= kept.from && depth <= kept.to)) return;
  }

  // Quantise it into the sort key
  const bool front = current.front == SurfaceClusters::Front::kBoth ||
                     (current.front == SurfaceClusters::Front::kClockwise) == attributes.is_clockwise();
  Crossing crossing{.order = bin_of(depth) << 1 | (front ? 1 : 0),
                    .slot = slot,
                    .depth = static_cast<float>(depth),
                    .surface = current.surface,
                    .triangle = current.triangle};
  if (has_nearest(slot) && !in_front(crossing, nearest_[slot])) return;

  std::array<float, 3> weight = t.weights(edges);
  attributes.correct(weight);
  crossing.weights = {weight[1], weight[2]};
  if (current.is_opaque) {
    nearest_[slot] = crossing;
    hiding_[slot] = hiding(crossing.depth);
    changed_ = true;
    return;
  }
  crossings_.push_back(crossing);
}

void TileRasterizer::sample_centers(const ScreenTriangle& t, const PixelBox& box, Current& current) {
  const EdgeWalk walk(t, box.x_first, box.y_first);
  for (std::int32_t y = box.y_first; y <= box.y_last; ++y) {
    EdgeWalk::Edges edges = walk.row(y - box.y_first);
    const std::int32_t row = (y - tile_.y_first) * TileBins::kTileSide - tile_.x_first;
    for (std::int32_t x = box.x_first; x <= box.x_last; ++x, walk.step(edges)) {
      if (EdgeWalk::inside(edges)) hit(t, edges, x, y, static_cast<std::uint32_t>(row + x), current);
    }
  }
}

void TileRasterizer::sample_patterns(const ScreenTriangle& t, const PixelBox& box, Current& current) {
  const EdgeWalk walk(t, box.x_first, box.y_first);
  for (std::int32_t y = box.y_first; y <= box.y_last; ++y) {
    EdgeWalk::Edges at_center = walk.row(y - box.y_first);
    const std::int32_t row = (y - tile_.y_first) * TileBins::kTileSide - tile_.x_first;
    for (std::int32_t x = box.x_first; x <= box.x_last; ++x, walk.step(at_center)) {
      const auto pixel = static_cast<std::uint32_t>(row + x);
      const std::uint32_t slot = slot_of_pixel_[pixel];
      if (slot == kNone || walk.misses_pixel(at_center) || current.nearest > pixel_hiding_[pixel]) continue;
      for (std::uint32_t n = 0; n < pattern_.size(); ++n) {
        const EdgeWalk::Edges edges = walk.moved(at_center, pattern_[n]);
        if (!EdgeWalk::inside(edges)) continue;
        hit(t, edges, x + pattern_[n].x / kSubPixels, y + pattern_[n].y / kSubPixels, slot + n, current);
      }
      if (current.is_opaque) renew_pixel(pixel);
    }
  }
}

}  // namespace splatlas

#include "player/render/surfaces/tile_rasterizer.h"

#include <algorithm>
#include <numeric>

#include "player/render/clip/cut_faces.h"

namespace splatlas {
namespace {

/// Depths behind this one are behind an opaque crossing by more than the width of a bin and rounding.
float hiding(float depth) {
  constexpr float kSurelyBehind = 2 / 4096.0f, kRounding = 0x1p-22f;
  return depth + kSurelyBehind + std::abs(depth) * kRounding;
}

}  // namespace

void ScreenCluster::place(const SurfaceClusters::Cluster& cluster, const RasterScene& scene,
                          const CutRays* cuts) {
  triangles_ = cluster.triangles;
  is_on_ = true;
  const auto sign = static_cast<float>(scene.depth_sign);
  for (std::size_t n = 0; n < cluster.positions_ijk.size(); ++n) {
    const std::array<float, 3>& position = cluster.positions_ijk[n];
    points_[n] = scene.projection.on_screen(position);
    const ScreenVertex vertex = splatlas::snapped(points_[n]);
    snapped_x_[n] = vertex.x;
    snapped_y_[n] = vertex.y;
    is_on_ = is_on_ && vertex.is_on();
    depths_[n] = sign * position[scene.depth_axis];
    removing_[n] = cuts != nullptr ? cuts->removing(position) : 0;
  }
}

std::span<const std::uint32_t> ScreenCluster::triangles_in(const PixelBox& box, std::int32_t reach) {
  if (!is_on_) {
    std::iota(chosen_.begin(), chosen_.end(), 0U);
    return std::span(chosen_).first(triangles_.size());
  }
  for (std::size_t n = 0; n < triangles_.size(); ++n) {
    const auto& [a, b, c] = triangles_[n].corners;
    corners_[n] = static_cast<std::uint32_t>(a | b << 8 | c << 16);
  }
  const std::size_t count = select_triangles(
      corners_.data(), triangles_.size(), {snapped_x_.data(), snapped_y_.data()}, box, reach, chosen_.data());
  return std::span(chosen_).first(count);
}

void TileRasterizer::begin(const RasterScene& scene, const PixelBox& tile, const TileOptions& options) {
  scene_ = &scene;
  tile_ = tile;
  slot_of_pixel_.clear();
  depth_.of_pixel.clear();
  faces_.clear();
  pattern_ = kCentre;
  seen_ = options.seen;
  clear(std::size_t{kStride} * kStride, options);
  // Nothing is seen outside the picture
  const auto columns = static_cast<std::uint32_t>(tile.x_last - tile.x_first + 1);
  const auto rows = static_cast<std::uint32_t>(tile.y_last - tile.y_first + 1);
  for (std::uint32_t y = 0; y < kStride; ++y) {
    const auto row = depth_.of_slot.begin() + std::ptrdiff_t{y} * kStride;
    std::fill(row + (y < rows ? columns : 0), row + kStride, -kNothingHidden);
    if (seen_.empty() || y >= rows) continue;
    std::fill_n(&seen_[scene.region.place(tile.x_first, tile.y_first + static_cast<std::int32_t>(y))],
                columns, SurfacesSeen{});
  }
  if (scene.faces == nullptr || (options.is_empty && !layers_.has_faces())) return;
  // Nothing is seen behind opaque faces
  for_each_pixel([&](std::size_t pixel, std::uint32_t slot) {
    if (scene.faces->hides(pixel)) depth_.of_slot[slot] = -kNothingHidden;
    if (layers_.has_faces()) layers_.pass_face(slot, scene.faces->front()[pixel]);
  });
  for (std::uint32_t block = 0; block < depth_.of_block.size(); ++block) renew_block(block);
}

void TileRasterizer::begin_edges(const RasterScene& scene, const PixelBox& tile,
                                 std::span<const std::uint8_t> wanted, std::span<const SubPixel> pattern,
                                 const TileOptions& options) {
  scene_ = &scene;
  tile_ = tile;
  pattern_ = pattern;
  slot_of_pixel_.assign(std::size_t{kStride} * kStride, kNone);
  depth_.of_pixel.assign(std::size_t{kStride} * kStride, -kNothingHidden);
  pixel_of_slot_.clear();
  seen_ = {};
  std::uint32_t slots = 0;
  for (std::int32_t y = tile.y_first; y <= tile.y_last; ++y) {
    for (std::int32_t x = tile.x_first; x <= tile.x_last; ++x) {
      if (wanted[scene.region.place(x, y)] == 0) continue;
      const auto pixel =
          static_cast<std::size_t>((y - tile.y_first) * TileBins::kTileSide + x - tile.x_first);
      slot_of_pixel_[pixel] = slots;
      pixel_of_slot_.push_back(static_cast<std::uint32_t>(pixel));
      depth_.of_pixel[pixel] = kNothingHidden;
      slots += static_cast<std::uint32_t>(pattern.size());
    }
  }
  clear(slots, options);
  faces_.clear();
  if (scene.sample_faces != nullptr && !options.keeps_fragments) pass_sample_faces();
  for (std::uint32_t block = 0; block < depth_.of_block.size(); ++block) renew_block(block);
}

/// Faces of the samples of edges. Nothing is seen behind opaque ones.
void TileRasterizer::pass_sample_faces() {
  const auto slots = static_cast<std::uint32_t>(pattern_.size());
  const auto columns = static_cast<std::size_t>(scene_->size.width);
  for_each_pixel([&](std::size_t pixel, std::uint32_t first_slot) {
    const std::size_t row = pixel / columns, column = pixel % columns;
    for (std::uint32_t n = 0; n < slots; ++n) {
      const double x = static_cast<double>(column) + pattern_[n].right();
      const double y = static_cast<double>(row) + pattern_[n].down();
      const RayFaces& faces = faces_.emplace_back(scene_->sample_faces->through(x, y));
      if (faces.front.rgba[3] >= 1) depth_.of_slot[first_slot + n] = -kNothingHidden;
      layers_.pass_face(first_slot + n, faces.front);
    }
    renew_pixel(pixel_of_slot_[first_slot / slots]);
  });
}

void TileRasterizer::clear(std::size_t slots, const TileOptions& options) {
  depth_.of_slot.assign(slots, kNothingHidden);
  depth_.nearest.resize(slots);
  depth_.of_block.fill(kNothingHidden);
  hull_.reset();
  layers_.begin(*scene_, tile_, slots, options);
}

void TileRasterizer::pass_layers(float depth) {
  const std::span<const std::uint32_t> ended = layers_.pass(depth);
  if (ended.empty()) return;
  for (const std::uint32_t slot : ended) {
    depth_.of_slot[slot] = -kNothingHidden;
    if (!slot_of_pixel_.empty()) renew_pixel(pixel_of_slot_[slot / pattern_.size()]);
  }
  for (std::uint32_t block = 0; block < depth_.of_block.size(); ++block) renew_block(block);
}

void TileRasterizer::change_hull(std::optional<std::uint32_t> ghost) {
  if (hull_) {
    std::swap(depth_, other_);
    for (std::uint32_t slot = 0; slot < other_.of_slot.size(); ++slot) {
      if (other_.has(slot) && scene_->surfaces[other_.nearest[slot].surface()].ghost == hull_)
        layers_.add() = other_.nearest[slot];
    }
  }
  hull_ = ghost;
  if (!hull_) return;
  other_.nearest.resize(depth_.nearest.size());
  for (std::uint32_t slot = 0; slot < depth_.of_slot.size(); ++slot)
    if (depth_.has(slot)) other_.nearest[slot] = depth_.nearest[slot];
  other_.of_slot = depth_.of_slot;
  other_.of_pixel = depth_.of_pixel;
  other_.of_block = depth_.of_block;
  std::swap(depth_, other_);
}

void TileRasterizer::draw(const TileCluster& of) {
  const SurfaceDraw& surface = scene_->surfaces[of.surface];
  if (surface.ghost != hull_) change_hull(surface.ghost);
  if (!hull_ && layers_.is_due()) pass_layers(of.nearest);
  if (is_hidden(of)) return;
  const SurfaceClusters::Cluster cluster = (*surface.clusters)[of.cluster];
  cluster_.place(cluster, *scene_, of.is_cut ? scene_->cuts : nullptr);
  changed_ = false;
  Current current;
  current.surface = of.surface;
  current.hides = surface.is_opaque() || surface.ghost;
  current.hides_back = surface.is_opaque() && surface.clusters->is_closed() && scene_->cuts == nullptr &&
                       scene_->projection.is_parallel();
  for (const std::uint32_t n : cluster_.triangles_in(tile_, slot_of_pixel_.empty() ? 0 : kHalfPixel)) {
    current.triangle = cluster.first + n;
    draw(cluster.triangles[n], current);
  }
  if (!changed_) return;
  for (std::uint32_t y = of.y_first; y <= of.y_last; ++y) {
    for (std::uint32_t x = of.x_first; x <= of.x_last; ++x) renew_block(y * kBlocks + x);
  }
}

/// True if every sample in the blocks of a cluster is behind an opaque surface, or behind its own hull.
bool TileRasterizer::is_hidden(const TileCluster& of) const {
  for (std::uint32_t y = of.y_first; y <= of.y_last; ++y) {
    for (std::uint32_t x = of.x_first; x <= of.x_last; ++x) {
      if (of.nearest <= depth_.of_block[y * kBlocks + x]) return false;
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
  const auto first = depth_.of_slot.begin() + slot_of_pixel_[pixel];
  depth_.of_pixel[pixel] = *std::max_element(first, first + static_cast<std::ptrdiff_t>(pattern_.size()));
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
  depth_.of_block[block] = *std::ranges::max_element(furthest);
}

void TileRasterizer::draw(const SurfaceClusters::Triangle& triangle, Current& current) {
  const auto& [a, b, c] = triangle.corners;
  const std::array<std::uint8_t, 3> removing{cluster_.removing(a), cluster_.removing(b),
                                             cluster_.removing(c)};
  if ((removing[0] & removing[1] & removing[2]) != 0) return;
  current.front = triangle.front;
  current.cuts = (removing[0] | removing[1] | removing[2]) != 0 ? scene_->cuts : nullptr;
  current.depths = {cluster_.depth(a), cluster_.depth(b), cluster_.depth(c)};
  current.nearest = std::min({cluster_.depth(a), cluster_.depth(b), cluster_.depth(c)});
  current.points = {cluster_.point(a), cluster_.point(b), cluster_.point(c)};
  const std::array<ScreenVertex, 3> snapped{cluster_.snapped(a), cluster_.snapped(b), cluster_.snapped(c)};
  if (snapped[0].is_on() && snapped[1].is_on() && snapped[2].is_on()) {
    draw_triangle(snapped, current);
  } else {
    draw_parts(current);
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
  const PixelBox whole = pixels_of(corners[0], corners[1], corners[2], at_centers ? 0 : kHalfPixel);
  const PixelBox box = intersection(whole, tile_);
  if (box.empty() || is_hidden(box, current.nearest)) return;
  const ScreenTriangle t(corners, area);
  current.attributes.reset();
  if (at_centers && whole.x_last - whole.x_first < SmallEdges::kMaxSide &&
      whole.y_last - whole.y_first < SmallEdges::kMaxSide) {
    sample_small(t, box, current);
  } else if (at_centers) {
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
  if (current.nearest > depth_.of_slot[slot]) return;
  if (!current.attributes) set_up_side(current);
  const TriangleAttributes& attributes = *current.attributes;
  const double depth = attributes.depth_at(x, y);
  if (static_cast<float>(depth) > depth_.of_slot[slot]) return;
  if (current.cuts != nullptr) {
    const ClipDepths kept = current.cuts->depths(x + 0.5, y + 0.5, scene_->depth_axis, scene_->depth_sign);
    if (!(depth >= kept.from && depth <= kept.to)) return;
  }

  const auto fill = [&](Crossing& crossing) {
    crossing.depth = depth;
    crossing.slot = slot;
    crossing.side = current.side;
    crossing.triangle = current.triangle;
    std::array<float, 3> weight = t.weights(edges);
    attributes.correct(weight);
    const float first_weight = 1 - weight[1] - weight[2];
    for (std::size_t c = 0; c < 3; ++c) {
      crossing.normal_lps[c] = first_weight * current.normals[0][c] + weight[1] * current.normals[1][c] +
                               weight[2] * current.normals[2][c];
    }
  };
  if (!depth_.has(slot) && !current.hides) {
    fill(layers_.add());
    return;
  }
  Crossing crossing;
  fill(crossing);
  if (depth_.has(slot) && !in_front(crossing, depth_.nearest[slot], *scene_)) return;
  if (current.hides) {
    depth_.nearest[slot] = crossing;
    depth_.of_slot[slot] = hiding(static_cast<float>(depth));
    changed_ = true;
  } else {
    layers_.add() = crossing;
  }
}

/// Finds the visible side of the triangle, and its normals.
void TileRasterizer::set_up_side(Current& current) const {
  current.attributes.emplace(current.points, current.depths, scene_->projection.is_parallel(), current.part);
  const bool front =
      current.front == SurfaceClusters::Front::kBoth ||
      (current.front == SurfaceClusters::Front::kClockwise) == current.attributes->is_clockwise();
  current.side = current.surface << 1 | (front ? 1 : 0);
  const auto corners = scene_->surfaces[current.surface].clusters->normals(current.triangle);
  for (std::size_t n = 0; n < 3; ++n) {
    for (std::size_t c = 0; c < 3; ++c) current.normals[n][c] = front ? corners[n][c] : -corners[n][c];
  }
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

void TileRasterizer::sample_small(const ScreenTriangle& t, const PixelBox& box, Current& current) {
  const EdgeWalk walk(t, box.x_first, box.y_first);
  std::array<std::uint32_t, SmallEdges::kMaxSide> covered;
  const std::int32_t rows = box.y_last - box.y_first + 1;
  cover_pixels(walk.small(), box.x_last - box.x_first + 1, rows, covered.data());
  for (std::int32_t y = 0; y < rows; ++y) {
    const std::int32_t row =
        (box.y_first + y - tile_.y_first) * TileBins::kTileSide + box.x_first - tile_.x_first;
    for (std::uint32_t bits = covered[static_cast<std::size_t>(y)]; bits != 0; bits &= bits - 1) {
      const std::int32_t x = std::countr_zero(bits);
      hit(t, walk.at(x, y), box.x_first + x, box.y_first + y, static_cast<std::uint32_t>(row + x), current);
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
      if (slot == kNone || walk.misses_pixel(at_center) || current.nearest > depth_.of_pixel[pixel]) continue;
      for (std::uint32_t n = 0; n < pattern_.size(); ++n) {
        const EdgeWalk::Edges edges = walk.moved(at_center, pattern_[n]);
        if (!EdgeWalk::inside(edges)) continue;
        hit(t, edges, x + pattern_[n].x / kSubPixels, y + pattern_[n].y / kSubPixels, slot + n, current);
      }
      if (current.hides) renew_pixel(pixel);
    }
  }
}

}  // namespace splatlas

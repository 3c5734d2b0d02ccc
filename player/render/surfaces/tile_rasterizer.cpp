#include "player/render/surfaces/tile_rasterizer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace splatlas {
namespace {

/// Surfaces coincide if their depths lie in the same bin of 1/4096 voxel. The offset moves bin limits away
/// from common surface depths such as half voxels, where rounding would decide.
constexpr double kDepthSteps = 4096;
constexpr double kDepthOffset = 0.3183;
constexpr double kDepthBias = 0x1p40;  // bins; exceeds the depth of any grid, so that all bins are positive
/// Sides of faces of cuts in SurfacesSeen::add().
constexpr std::uint32_t kFaceSide = 0x80000000;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

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
  for (std::uint32_t y = 0; y < kStride && columns + rows < 2 * kStride; ++y) {
    const auto row = hiding_.begin() + y * kStride;
    std::fill(row + (y < rows ? columns : 0), row + kStride, -kInfinity);
  }
}

void TileRasterizer::begin_edges(const RasterScene& scene, const PixelBox& tile,
                                 std::span<const std::uint8_t> wanted, std::span<const SubPixel> pattern) {
  scene_ = &scene;
  tile_ = tile;
  pattern_ = pattern;
  slot_of_pixel_.assign(std::size_t{kStride} * kStride, kNone);
  pixel_hiding_.assign(std::size_t{kStride} * kStride, -kInfinity);
  std::uint32_t slots = 0;
  for (std::int32_t y = tile.y_first; y <= tile.y_last; ++y) {
    const std::size_t row = static_cast<std::size_t>(y) * static_cast<std::size_t>(scene.size.width);
    for (std::int32_t x = tile.x_first; x <= tile.x_last; ++x) {
      if (wanted[row + static_cast<std::size_t>(x)] == 0) continue;
      const auto pixel =
          static_cast<std::size_t>((y - tile.y_first) * TileBins::kTileSide + x - tile.x_first);
      slot_of_pixel_[pixel] = slots;
      pixel_hiding_[pixel] = kInfinity;
      slots += static_cast<std::uint32_t>(pattern.size());
    }
  }
  clear(slots);
  for (std::uint32_t block = 0; block < block_hiding_.size(); ++block) renew_block(block);
}

void TileRasterizer::clear(std::size_t slots) {
  hiding_.assign(slots, kInfinity);
  nearest_.resize(slots);
  block_hiding_.fill(kInfinity);
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
  current.is_opaque = surface.opacity >= 1;
  for (std::size_t n = 0; n < cluster.triangles.size(); ++n) {
    const SurfaceClusters::Triangle& triangle = cluster.triangles[n];
    const Vertex& a = vertices_[triangle.corners[0]];
    const Vertex& b = vertices_[triangle.corners[1]];
    const Vertex& c = vertices_[triangle.corners[2]];
    if ((a.removing & b.removing & c.removing) != 0) continue;
    current.triangle = cluster.numbers[n];
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
  const float* row = hiding_of_pixels() + block / kBlocks * kSide * kStride + block % kBlocks * kSide;
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
  clip_triangle(*scene_->surfaces[current.surface].mesh, current.triangle, scene_->projection, parts_);
  const std::array<double, 3> of_triangle = current.depths;
  for (const ClippedTriangle& part : parts_) {
    current.part = &part;
    current.points = part.corner;
    for (std::size_t n = 0; n < 3; ++n)
      current.depths[n] = TriangleAttributes::mixed(part.weights[n], of_triangle);
    draw_triangle({snapped(part.corner[0]), snapped(part.corner[1]), snapped(part.corner[2])}, current);
  }
  current.part = nullptr;
}

void TileRasterizer::draw_triangle(const std::array<ScreenVertex, 3>& corners, Current& current) {
  const bool at_centers = slot_of_pixel_.empty();
  const PixelBox box =
      intersection(pixels_of(corners[0], corners[1], corners[2], at_centers ? 0 : kHalfPixel), tile_);
  if (box.empty() || is_hidden(box, current.nearest)) return;
  const ScreenTriangle t(corners);
  if (t.area == 0) return;
  current.attributes.reset();
  if (at_centers) {
    sample_centers(t, box, current);
  } else {
    sample_patterns(t, box, current);
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

void TileRasterizer::sample_patterns(const ScreenTriangle& t, const PixelBox& box, Current& current) {
  const EdgeWalk walk(t, box.x_first, box.y_first);
  for (std::int32_t y = box.y_first; y <= box.y_last; ++y) {
    EdgeWalk::Edges at_center = walk.row(y - box.y_first);
    const std::int32_t row = (y - tile_.y_first) * TileBins::kTileSide - tile_.x_first;
    for (std::int32_t x = box.x_first; x <= box.x_last; ++x, walk.step(at_center)) {
      const std::uint32_t slot = slot_of_pixel_[static_cast<std::size_t>(row + x)];
      if (slot == kNone || walk.misses_pixel(at_center)) continue;
      if (current.nearest > pixel_hiding_[static_cast<std::size_t>(row + x)]) continue;
      for (std::uint32_t n = 0; n < pattern_.size(); ++n) {
        const EdgeWalk::Edges edges = walk.moved(at_center, pattern_[n]);
        if (!EdgeWalk::inside(edges)) continue;
        hit(t, edges, x + pattern_[n].x / kSubPixels, y + pattern_[n].y / kSubPixels, slot + n, current);
      }
      if (current.is_opaque) renew_pixel(static_cast<std::uint32_t>(row + x));
    }
  }
}

void TileRasterizer::hit(const ScreenTriangle& t, const EdgeWalk::Edges& edges, double x, double y,
                         std::uint32_t slot, Current& current) {
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
  const double step = std::floor(depth * kDepthSteps + kDepthOffset) + kDepthBias;
  const bool front = current.front == SurfaceClusters::Front::kBoth ||
                     (current.front == SurfaceClusters::Front::kClockwise) == attributes.is_clockwise();
  Crossing crossing{.order = (static_cast<std::uint64_t>(step) << 1) | (front ? 1 : 0),
                    .slot = slot,
                    .depth = static_cast<float>(depth),
                    .surface = current.surface,
                    .triangle = current.triangle};
  if (hiding_[slot] < kInfinity && !in_front(crossing, nearest_[slot])) return;

  // Keep an opaque crossing, which is shaded later, or shade a translucent one
  std::array<float, 3> weight = t.weights(edges);
  attributes.correct(weight);
  if (current.is_opaque) {
    crossing.shading = {weight[1], weight[2]};
    nearest_[slot] = crossing;
    hiding_[slot] = hiding(crossing.depth);
    changed_ = true;
    return;
  }
  const SurfaceShading shading = shade(crossing, weight);
  crossing.shading = {shading.diffuse, shading.highlight};
  crossings_.push_back(crossing);
}

bool TileRasterizer::in_front(const Crossing& a, const Crossing& b) const {
  if (a.order != b.order) return a.order < b.order;
  const StructureIndex of_a = scene_->surfaces[a.surface].structure;
  const StructureIndex of_b = scene_->surfaces[b.surface].structure;
  return of_a != of_b ? of_a < of_b : a.triangle < b.triangle;
}

SurfaceShading TileRasterizer::shade(const Crossing& crossing, const std::array<float, 3>& weight) const {
  const SurfaceMesh& mesh = *scene_->surfaces[crossing.surface].mesh;
  const auto& corners = mesh.triangles[crossing.triangle];
  std::array<float, 3> normal{};
  for (std::size_t n = 0; n < 3; ++n) {
    for (std::size_t c = 0; c < 3; ++c) normal[c] += weight[n] * mesh.normals_lps[corners[n]][c];
  }
  if ((crossing.order & 1) == 0) normal = {-normal[0], -normal[1], -normal[2]};  // the back face
  return scene_->lighting.on_surface(normal);
}

Fragment TileRasterizer::fragment(const Crossing& crossing, const SurfaceShading& shading) const {
  const SurfaceDraw& surface = scene_->surfaces[crossing.surface];
  Fragment fragment{crossing.depth, {0, 0, 0, surface.opacity}, surface.structure};
  for (std::size_t c = 0; c < 3; ++c) fragment.rgba[c] = shading.on(surface.color[c]) * surface.opacity;
  return fragment;
}

template <typename Visit>
void TileRasterizer::for_each_pixel(const Visit& visit) const {
  for (std::int32_t y = tile_.y_first; y <= tile_.y_last; ++y) {
    const std::size_t row = static_cast<std::size_t>(y) * static_cast<std::size_t>(scene_->size.width);
    auto in_tile = static_cast<std::uint32_t>(y - tile_.y_first) * kStride;
    for (std::int32_t x = tile_.x_first; x <= tile_.x_last; ++x, ++in_tile) {
      const std::uint32_t slot = slot_of_pixel_.empty() ? in_tile : slot_of_pixel_[in_tile];
      if (slot != kNone) visit(row + static_cast<std::size_t>(x), slot);
    }
  }
}

void TileRasterizer::finish(float termination_threshold, TileFragments& out, std::span<SurfacesSeen> seen) {
  sort_by_slot();
  out.fragments.clear();
  out.end_of_slot.assign(hiding_.size(), 0);
  const bool has_faces = slot_of_pixel_.empty() && scene_->faces != nullptr;
  std::uint32_t next = 0;
  for_each_pixel([&](std::size_t pixel, std::uint32_t first_slot) {
    const auto end = static_cast<std::uint32_t>(out.fragments.size());
    for (; next < first_slot; ++next) out.end_of_slot[next] = end;  // outside the picture
    const RayFaces faces = has_faces ? scene_->faces->at(pixel) : RayFaces{};
    for (; next < first_slot + pattern_.size(); ++next) {
      finish_slot(next, faces, termination_threshold, &out.fragments, seen.empty() ? nullptr : &seen[pixel]);
      out.end_of_slot[next] = static_cast<std::uint32_t>(out.fragments.size());
    }
  });
}

void TileRasterizer::paint(float termination_threshold, Picture& picture, std::span<SurfacesSeen> seen) {
  sort_by_slot();
  const auto slots = static_cast<std::uint32_t>(pattern_.size());
  for_each_pixel([&](std::size_t pixel, std::uint32_t first_slot) {
    Radiance sum;
    for (std::uint32_t slot = first_slot; slot < first_slot + slots; ++slot)
      sum += finish_slot(slot, {}, termination_threshold, nullptr, seen.empty() ? nullptr : &seen[pixel]);
    for (std::size_t c = 0; c < 4; ++c) picture.rgba[4 * pixel + c] = sum.rgba[c] / static_cast<float>(slots);
  });
}

Radiance TileRasterizer::finish_slot(std::uint32_t slot, const RayFaces& faces, float termination_threshold,
                                     std::vector<Fragment>* out, SurfacesSeen* seen) {
  if (seen != nullptr) *seen = {};
  Radiance sum;
  float transmittance = 1;
  const auto pass_face = [&](const Face& face) {
    if (seen != nullptr && face.shows() && transmittance > termination_threshold)
      seen->add(kFaceSide | face.structure, transmittance, {face.depth, face.rgba, face.structure});
    transmittance *= 1 - face.rgba[3];
  };
  const auto pass = [&](const Crossing& crossing, const SurfaceShading& shading) {
    const Fragment last = fragment(crossing, shading);
    const std::uint32_t side = (crossing.surface << 1) | static_cast<std::uint32_t>(crossing.order & 1);
    if (out != nullptr) out->push_back(last);
    if (seen != nullptr) seen->add(side, transmittance, last);
    for (std::size_t c = 0; c < 4; ++c) sum.rgba[c] += transmittance * last.rgba[c];
    transmittance *= 1 - last.rgba[3];
  };
  pass_face(faces.front);
  if (!end_of_slot_.empty()) {
    const std::uint32_t begin = slot == 0 ? 0 : end_of_slot_[slot - 1];
    const auto of_slot = std::span(order_).subspan(begin, end_of_slot_[slot] - begin);
    sort_slot(of_slot);
    for (const std::uint32_t n : of_slot) {
      if (transmittance <= termination_threshold) break;
      pass(sorted_[n], {sorted_[n].shading[0], sorted_[n].shading[1]});
    }
  }
  if (hiding_[slot] < kInfinity && transmittance > termination_threshold) {
    const auto [second, third] = nearest_[slot].shading;
    pass(nearest_[slot], shade(nearest_[slot], {1 - second - third, second, third}));
  }
  pass_face(faces.back);
  return sum;
}

/// Counting sort of translucent crossings.
void TileRasterizer::sort_by_slot() {
  end_of_slot_.clear();
  if (crossings_.empty()) return;
  end_of_slot_.assign(hiding_.size(), 0);
  for (const Crossing& crossing : crossings_) ++end_of_slot_[crossing.slot];
  std::uint32_t begin = 0;
  for (std::uint32_t& end : end_of_slot_) begin += std::exchange(end, begin);
  sorted_.resize(crossings_.size());
  order_.resize(crossings_.size());
  for (const Crossing& crossing : crossings_) {
    const std::uint32_t n = end_of_slot_[crossing.slot]++;
    sorted_[n] = crossing;
    order_[n] = n;
  }
}

/// Insertion sort: a slot has few crossings, which are often in order.
void TileRasterizer::sort_slot(std::span<std::uint32_t> of_slot) const {
  constexpr std::size_t kFew = 32;
  const auto before = [&](std::uint32_t a, std::uint32_t b) { return in_front(sorted_[a], sorted_[b]); };
  if (of_slot.size() > kFew) {
    std::sort(of_slot.begin(), of_slot.end(), before);
    return;
  }
  for (std::size_t n = 1; n < of_slot.size(); ++n) {
    const std::uint32_t moved = of_slot[n];
    std::size_t to = n;
    for (; to > 0 && before(moved, of_slot[to - 1]); --to) of_slot[to] = of_slot[to - 1];
    of_slot[to] = moved;
  }
}

}  // namespace splatlas

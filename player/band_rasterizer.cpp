#include "player/band_rasterizer.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>
#include <utility>

namespace splatlas {
namespace {

/// Surfaces coincide whose depths lie in the same 1/4096 voxel. The offset keeps the limits away from the
/// depths that surfaces between voxels have, where rounding would decide.
constexpr double kDepthSteps = 4096;
constexpr double kDepthOffset = 0.3183;
constexpr double kDepthBias = 0x1p40;  // steps: more than any grid is deep, to make all of them positive

/// Linear over the screen.
struct ScreenPlane {
  double at_origin = 0, per_x = 0, per_y = 0;
};

}  // namespace

RasterScene raster_scene(std::span<const SurfaceDraw> surfaces, const ParallelView& view, const Shear& shear,
                         const Grid& grid, const Lighting& lighting) {
  return {surfaces,
          view.size,
          Projection(view, grid),
          Facing(grid),
          lighting,
          shear.scan.slice_axis,
          shear.ascending ? 1.0 : -1.0};
}

/// A triangle's corners, turned so that the inside has positive edge functions.
struct BandRasterizer::Triangle {
  TriangleRef ref;
  std::array<ScreenVertex, 3> corner;
  std::int64_t area = 0;  ///< doubled; 0: leave it

  Triangle(const TriangleRef& triangle, std::array<ScreenVertex, 3> v) : ref(triangle), corner(v) {
    area = edge(1, 2, v[0].x, v[0].y);
    turned_ = area < 0;
    if (turned_) {
      std::swap(corner[1], corner[2]);
      area = -area;
    }
  }
  /// Of the edge between two corners; positive on the inner side.
  [[nodiscard]] std::int64_t edge(std::size_t from, std::size_t to, std::int64_t x, std::int64_t y) const {
    return (corner[to].x - corner[from].x) * (y - corner[from].y) -
           (corner[to].y - corner[from].y) * (x - corner[from].x);
  }
  /// Added to the edge function: what is then not negative is inside. Points on an edge belong to the
  /// triangle whose left or top edge it is.
  [[nodiscard]] std::int64_t bias(std::size_t from, std::size_t to) const {
    const std::int32_t down = corner[to].y - corner[from].y;
    return down < 0 || (down == 0 && corner[to].x > corner[from].x) ? 0 : -1;
  }
  /// Of the mesh's corners, from edge functions without bias.
  [[nodiscard]] std::array<float, 3> weights(const std::array<std::int64_t, 3>& edges) const {
    const double per_area = 1 / static_cast<double>(area);
    std::array<float, 3> weight{};
    for (std::size_t n = 0; n < 3; ++n) {
      weight[n] = static_cast<float>(static_cast<double>(edges[n]) * per_area);
    }
    if (turned_) std::swap(weight[1], weight[2]);
    return weight;
  }

 private:
  bool turned_ = false;
};

/// What is worked out once the first sample of a triangle is found. From vertices that are not snapped, so
/// that coplanar triangles agree wherever they cover the same sample, however each surface is cut.
class BandRasterizer::Attributes {
 public:
  Attributes(const RasterScene& scene, const TriangleRef& ref) : parallel_(scene.projection.is_parallel()) {
    const SurfaceMesh& mesh = *scene.surfaces[ref.surface].mesh;
    const auto& corners = mesh.triangles[ref.triangle];
    std::array<ScreenPoint, 3> p;
    std::array<double, 3> depth{};
    for (std::size_t n = 0; n < 3; ++n) {
      const std::array<float, 3>& position = mesh.positions_ijk[corners[n]];
      p[n] = scene.projection.on_screen(position);
      depth[n] = scene.depth_sign * static_cast<double>(position[scene.depth_axis]);
      per_w_[n] = 1 / p[n].w;
    }
    std::tie(nearest_, furthest_) = std::minmax({depth[0], depth[1], depth[2]});
    x0_ = p[0].x;
    y0_ = p[0].y;
    const double x1 = p[1].x - x0_;
    const double y1 = p[1].y - y0_;
    const double x2 = p[2].x - x0_;
    const double y2 = p[2].y - y0_;
    const double area = x1 * y2 - y1 * x2;
    front_ = scene.facing.shows_front(mesh, corners, area > 0);
    const auto plane_through = [&](double at_0, double at_1, double at_2) {
      ScreenPlane plane{at_0, 0, 0};
      if (area == 0) return plane;
      plane.per_x = ((at_1 - at_0) * y2 - (at_2 - at_0) * y1) / area;
      plane.per_y = ((at_2 - at_0) * x1 - (at_1 - at_0) * x2) / area;
      return plane;
    };
    depth_ = plane_through(depth[0] * per_w_[0], depth[1] * per_w_[1], depth[2] * per_w_[2]);
    if (!parallel_) inverse_w_ = plane_through(per_w_[0], per_w_[1], per_w_[2]);
  }

  [[nodiscard]] bool front() const { return front_; }
  /// Snapping lets a triangle cover samples that are just beside it: clamped to the depths of its corners.
  [[nodiscard]] double depth_at(double x, double y) const {
    const double depth = at(depth_, x, y) / (parallel_ ? 1 : at(inverse_w_, x, y));
    return std::clamp(depth, nearest_, furthest_);
  }
  /// Weights over the screen to weights over the triangle.
  void correct(std::array<float, 3>& weight) const {
    if (parallel_) return;
    float sum = 0;
    for (std::size_t n = 0; n < 3; ++n) {
      weight[n] *= static_cast<float>(per_w_[n]);
      sum += weight[n];
    }
    for (float& w : weight) w /= sum;
  }

 private:
  [[nodiscard]] double at(const ScreenPlane& plane, double x, double y) const {
    return plane.at_origin + plane.per_x * (x - x0_) + plane.per_y * (y - y0_);
  }

  bool parallel_;
  bool front_ = true;
  double x0_ = 0, y0_ = 0, nearest_ = 0, furthest_ = 0;
  std::array<double, 3> per_w_{1, 1, 1};
  ScreenPlane depth_, inverse_w_{1, 0, 0};
};

void BandRasterizer::begin(const RasterScene& scene, const TriangleBins& bins, int first_row, int last_row) {
  scene_ = &scene;
  bins_ = &bins;
  width_ = scene.size.width;
  first_row_ = first_row;
  last_row_ = last_row;
  const auto slots = static_cast<std::size_t>(width_) * static_cast<std::size_t>(last_row - first_row);
  const bool any_opaque = std::any_of(scene.surfaces.begin(), scene.surfaces.end(),
                                      [](const SurfaceDraw& surface) { return surface.opacity >= 1; });
  nearest_.assign(any_opaque ? slots : 0, Crossing{});
  crossings_.clear();
  end_of_slot_.assign(slots, 0);
  kept_.assign(slots, 0);
}

void BandRasterizer::draw(const TriangleRef& ref) {
  const auto& corners = scene_->surfaces[ref.surface].mesh->triangles[ref.triangle];
  const std::span<const ScreenVertex> vertices = bins_->vertices(ref.surface);
  const Triangle t(ref, {vertices[corners[0]], vertices[corners[1]], vertices[corners[2]]});
  if (t.area == 0) return;
  const auto [x_low, x_high] = std::minmax({t.corner[0].x, t.corner[1].x, t.corner[2].x});
  const auto [y_low, y_high] = std::minmax({t.corner[0].y, t.corner[1].y, t.corner[2].y});
  const std::int32_t x_first = std::max(0, first_pixel(x_low));
  const std::int32_t x_last = std::min(width_ - 1, last_pixel(x_high));
  const std::int32_t y_first = std::max(first_row_, first_pixel(y_low));
  const std::int32_t y_last = std::min(last_row_ - 1, last_pixel(y_high));
  const std::array<std::int64_t, 3> bias{t.bias(1, 2), t.bias(2, 0), t.bias(0, 1)};
  std::optional<Attributes> attributes;
  for (std::int32_t y = y_first; y <= y_last; ++y) {
    for (std::int32_t x = x_first; x <= x_last; ++x) {
      const std::int64_t sub_x = std::int64_t{x} << kSubPixelBits;
      const std::int64_t sub_y = std::int64_t{y} << kSubPixelBits;
      const std::array<std::int64_t, 3> edges{t.edge(1, 2, sub_x, sub_y), t.edge(2, 0, sub_x, sub_y),
                                              t.edge(0, 1, sub_x, sub_y)};
      if (((edges[0] + bias[0]) | (edges[1] + bias[1]) | (edges[2] + bias[2])) < 0) continue;
      if (!attributes) attributes.emplace(*scene_, ref);
      add(t, *attributes, static_cast<std::uint32_t>((y - first_row_) * width_ + x), t.weights(edges),
          attributes->depth_at(x, y));
    }
  }
}

bool BandRasterizer::in_front(const Crossing& a, const Crossing& b) const {
  if (a.order != b.order) return a.order < b.order;
  const StructureIndex of_a = scene_->surfaces[a.surface].structure;
  const StructureIndex of_b = scene_->surfaces[b.surface].structure;
  return of_a != of_b ? of_a < of_b : a.triangle < b.triangle;
}

void BandRasterizer::add(const Triangle& triangle, const Attributes& attributes, std::uint32_t slot,
                         const std::array<float, 3>& weight, double depth) {
  const SurfaceDraw& surface = scene_->surfaces[triangle.ref.surface];
  Crossing crossing;
  const double step = std::floor(depth * kDepthSteps + kDepthOffset) + kDepthBias;
  crossing.order = (static_cast<std::uint64_t>(step) << 1) | (attributes.front() ? 1 : 0);
  crossing.slot = slot;
  crossing.depth = static_cast<float>(depth);
  crossing.surface = triangle.ref.surface;
  crossing.triangle = triangle.ref.triangle;
  if (!nearest_.empty()) {
    Crossing& nearest = nearest_[slot];
    if (nearest.surface != kNone && !in_front(crossing, nearest)) return;
    if (surface.opacity >= 1) {
      crossing.light = {weight[1], weight[2]};
      nearest = crossing;
      return;
    }
  }
  std::array<float, 3> corrected = weight;
  attributes.correct(corrected);
  const SurfaceLight light = lit(*surface.mesh, triangle.ref.triangle, attributes.front(), corrected);
  crossing.light = {light.diffuse, light.highlight};
  crossings_.push_back(crossing);
}

SurfaceLight BandRasterizer::lit(const SurfaceMesh& mesh, std::uint32_t triangle, bool front,
                                 const std::array<float, 3>& weight) const {
  const auto& corners = mesh.triangles[triangle];
  std::array<float, 3> normal{};
  for (std::size_t n = 0; n < 3; ++n) {
    for (std::size_t c = 0; c < 3; ++c) normal[c] += weight[n] * mesh.normals_lps[corners[n]][c];
  }
  if (!front) normal = {-normal[0], -normal[1], -normal[2]};
  return scene_->lighting.on_surface(normal);
}

void BandRasterizer::finish(float transmittance_floor) {
  take_opaque();
  sort_by_slot();
  std::uint32_t begin = 0;
  for (std::size_t slot = 0; slot < end_of_slot_.size(); ++slot) {
    const std::uint32_t end = end_of_slot_[slot];
    if (end - begin > 1) sort_slot(std::span(order_).subspan(begin, end - begin));
    float through = 1;
    std::uint32_t kept = begin;
    while (kept < end && through > transmittance_floor) {
      through *= 1 - scene_->surfaces[crossings_[order_[kept++]].surface].opacity;
    }
    kept_[slot] = kept - begin;
    begin = end;
  }
}

void BandRasterizer::take_opaque() {
  for (const Crossing& nearest : nearest_) {
    if (nearest.surface == kNone) continue;
    const auto [second, third] = nearest.light;
    const SurfaceLight light = lit(*scene_->surfaces[nearest.surface].mesh, nearest.triangle,
                                   (nearest.order & 1) != 0, {1 - second - third, second, third});
    crossings_.push_back(nearest);
    crossings_.back().light = {light.diffuse, light.highlight};
  }
}

/// A counting sort of indices.
void BandRasterizer::sort_by_slot() {
  std::fill(end_of_slot_.begin(), end_of_slot_.end(), 0);
  for (const Crossing& crossing : crossings_) ++end_of_slot_[crossing.slot];
  std::uint32_t begin = 0;
  for (std::uint32_t& end : end_of_slot_) begin += std::exchange(end, begin);
  order_.resize(crossings_.size());
  for (std::uint32_t n = 0; n < crossings_.size(); ++n) order_[end_of_slot_[crossings_[n].slot]++] = n;
}

/// Insertion: a slot has few crossings, often in order already.
void BandRasterizer::sort_slot(std::span<std::uint32_t> of_slot) const {
  constexpr std::size_t kFew = 32;
  const auto before = [&](std::uint32_t a, std::uint32_t b) {
    return in_front(crossings_[a], crossings_[b]);
  };
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

void BandRasterizer::store(std::size_t slot, Fragment* out) const {
  const std::uint32_t begin = slot == 0 ? 0 : end_of_slot_[slot - 1];
  for (std::uint32_t n = begin; n < begin + kept_[slot]; ++n) {
    const Crossing& crossing = crossings_[order_[n]];
    const SurfaceDraw& surface = scene_->surfaces[crossing.surface];
    const SurfaceLight light{crossing.light[0], crossing.light[1]};
    out->depth = crossing.depth;
    for (std::size_t c = 0; c < 3; ++c) out->rgba[c] = light.on(surface.color[c]) * surface.opacity;
    out->rgba[3] = surface.opacity;
    out->structure = surface.structure;
    ++out;
  }
}

}  // namespace splatlas

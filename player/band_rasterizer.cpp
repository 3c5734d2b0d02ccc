#include "player/band_rasterizer.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>
#include <utility>

namespace splatlas {
namespace {

constexpr double kSubPixels = 1 << kSubPixelBits;
constexpr std::int32_t kHalfPixel = 1 << (kSubPixelBits - 1);
/// Surfaces coincide whose depths lie in the same 1/4096 voxel. The offset keeps the limits away from the
/// depths that surfaces between voxels have, where rounding would decide.
constexpr double kDepthSteps = 4096;
constexpr double kDepthOffset = 0.3183;
/// Voxels, and a share of the depth: more than coinciding depths and rounding come to.
constexpr float kSurelyBehind = 2 / 4096.0f;
constexpr float kRounding = 0x1p-22f;
constexpr double kDepthBias = 0x1p40;  // steps: more than any grid is deep, to make all of them positive

/// Positive where the corners are seen clockwise.
std::int64_t doubled_area(const ScreenVertex& a, const ScreenVertex& b, const ScreenVertex& c) {
  return std::int64_t{b.x - a.x} * (c.y - a.y) - std::int64_t{b.y - a.y} * (c.x - a.x);
}

/// Linear over the screen.
struct ScreenPlane {
  double at_origin = 0, per_x = 0, per_y = 0;
};

}  // namespace

RasterScene raster_scene(std::span<const SurfaceDraw> surfaces, const ParallelView& view, const Shear& shear,
                         const Grid& grid, const Lighting& lighting) {
  const Vec3 along = lps_mm_to_index(grid).apply_linear(view.forward_lps);
  const double voxels_per_mm = std::abs(along[shear.scan.slice_axis]);
  return {surfaces,
          view.size,
          Projection(view, grid),
          Facing(grid),
          lighting,
          shear.scan.slice_axis,
          shear.ascending ? 1.0 : -1.0,
          static_cast<float>(view.mm_per_pixel * voxels_per_mm)};
}

/// A triangle's corners, turned so that the inside has positive edge functions.
struct BandRasterizer::Triangle {
  TriangleRef ref;
  std::array<ScreenVertex, 3> corner;
  std::int64_t area = 0;  ///< doubled; 0: leave it
  /// 1 for edges whose points are outside, 0 for those whose points are inside.
  std::array<std::int64_t, 3> opened{};

  Triangle(const TriangleRef& triangle, std::array<ScreenVertex, 3> v) : ref(triangle), corner(v) {
    area = doubled_area(v[0], v[1], v[2]);
    turned_ = area < 0;
    if (turned_) {
      std::swap(corner[1], corner[2]);
      area = -area;
    }
    // Points on an edge belong to the triangle whose left or top edge it is.
    for (std::size_t n = 0; n < 3; ++n) {
      const ScreenVertex& from = corner[(n + 1) % 3];
      const ScreenVertex& to = corner[(n + 2) % 3];
      opened[n] = to.y < from.y || (to.y == from.y && to.x > from.x) ? 0 : 1;
    }
  }
  /// Of the mesh's corners, from the edge functions.
  [[nodiscard]] std::array<float, 3> weights(const std::array<std::int64_t, 3>& edges) const {
    const double per_area = 1 / static_cast<double>(area);
    std::array<float, 3> weight{};
    for (std::size_t n = 0; n < 3; ++n) {
      weight[n] = static_cast<float>(static_cast<double>(edges[n] + opened[n]) * per_area);
    }
    if (turned_) std::swap(weight[1], weight[2]);
    return weight;
  }

 private:
  bool turned_ = false;
};

/// The edge functions of a triangle from pixel to pixel: edge n is opposite to corner n. Positive inside;
/// less 1 for open edges, so that what is not negative is inside.
class BandRasterizer::EdgeWalk {
 public:
  using Edges = std::array<std::int64_t, 3>;

  EdgeWalk(const Triangle& t, std::int32_t x, std::int32_t y) {
    const ScreenVertex center{x << kSubPixelBits, y << kSubPixelBits};
    for (std::size_t n = 0; n < 3; ++n) {
      const ScreenVertex& from = t.corner[(n + 1) % 3];
      const ScreenVertex& to = t.corner[(n + 2) % 3];
      first_[n] = doubled_area(from, to, center) - t.opened[n];
      per_x_[n] = from.y - to.y;
      per_y_[n] = to.x - from.x;
      reach_[n] = (std::abs(per_x_[n]) + std::abs(per_y_[n])) * kHalfPixel;
    }
  }
  [[nodiscard]] Edges row(std::int64_t down) const {
    Edges edges = first_;
    for (std::size_t n = 0; n < 3; ++n) edges[n] += (down << kSubPixelBits) * per_y_[n];
    return edges;
  }
  void step(Edges& edges) const {
    for (std::size_t n = 0; n < 3; ++n) edges[n] += per_x_[n] << kSubPixelBits;
  }
  [[nodiscard]] Edges moved(Edges edges, const SubPixel& by) const {
    for (std::size_t n = 0; n < 3; ++n) edges[n] += by.x * per_x_[n] + by.y * per_y_[n];
    return edges;
  }
  /// No point of the pixel around this centre is inside.
  [[nodiscard]] bool misses_pixel(const Edges& at_center) const {
    return ((at_center[0] + reach_[0]) | (at_center[1] + reach_[1]) | (at_center[2] + reach_[2])) < 0;
  }
  static bool inside(const Edges& edges) { return (edges[0] | edges[1] | edges[2]) >= 0; }

 private:
  Edges first_{}, per_x_{}, per_y_{};
  Edges reach_{};  // how much more an edge function can be within half a pixel
};

/// What is worked out once the first sample of a triangle is found. From vertices that are not snapped, so
/// that coplanar triangles agree wherever they cover the same sample, however each surface is cut.
class BandRasterizer::Attributes {
 public:
  Attributes(const RasterScene& scene, const TriangleRef& ref)
      : parallel_(scene.projection.is_parallel()), part_(ref.part) {
    const SurfaceMesh& mesh = *scene.surfaces[ref.surface].mesh;
    const auto& corners = mesh.triangles[ref.triangle];
    std::array<ScreenPoint, 3> p;
    std::array<double, 3> depth{};
    for (std::size_t n = 0; n < 3; ++n) {
      const std::array<float, 3>& position = mesh.positions_ijk[corners[n]];
      if (part_ == nullptr) p[n] = scene.projection.on_screen(position);
      depth[n] = scene.depth_sign * static_cast<double>(position[scene.depth_axis]);
    }
    if (part_ != nullptr) {
      p = part_->corner;
      const std::array<double, 3> of_triangle = depth;
      for (std::size_t n = 0; n < 3; ++n) depth[n] = mixed(part_->weights[n], of_triangle);
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
    const double per_area = area == 0 ? 0 : 1 / area;
    const auto plane_through = [&](const std::array<double, 3>& value) {
      const double rise_1 = (value[1] - value[0]) * per_area;
      const double rise_2 = (value[2] - value[0]) * per_area;
      return ScreenPlane{value[0], rise_1 * y2 - rise_2 * y1, rise_2 * x1 - rise_1 * x2};
    };
    if (parallel_) {
      depth_ = plane_through(depth);
      return;
    }
    for (std::size_t n = 0; n < 3; ++n) {
      per_w_[n] = 1 / p[n].w;
      depth[n] *= per_w_[n];
    }
    depth_ = plane_through(depth);
    inverse_w_ = plane_through(per_w_);
  }

  [[nodiscard]] bool front() const { return front_; }
  /// Snapping lets a triangle cover samples that are just beside it: clamped to the depths of its corners.
  [[nodiscard]] double depth_at(double x, double y) const {
    const double depth = at(depth_, x, y) / (parallel_ ? 1 : at(inverse_w_, x, y));
    return std::clamp(depth, nearest_, furthest_);
  }
  /// Weights of the corners on the screen to weights of the mesh's corners.
  void correct(std::array<float, 3>& weight) const {
    if (!parallel_) {
      float sum = 0;
      for (std::size_t n = 0; n < 3; ++n) {
        weight[n] *= static_cast<float>(per_w_[n]);
        sum += weight[n];
      }
      for (float& w : weight) w /= sum;
    }
    if (part_ == nullptr) return;
    const std::array<double, 3> of_part{weight[0], weight[1], weight[2]};
    for (std::size_t n = 0; n < 3; ++n) {
      weight[n] = static_cast<float>(
          mixed(of_part, {part_->weights[0][n], part_->weights[1][n], part_->weights[2][n]}));
    }
  }

 private:
  [[nodiscard]] double at(const ScreenPlane& plane, double x, double y) const {
    return plane.at_origin + plane.per_x * (x - x0_) + plane.per_y * (y - y0_);
  }

  static double mixed(const std::array<double, 3>& weights, const std::array<double, 3>& values) {
    return weights[0] * values[0] + weights[1] * values[1] + weights[2] * values[2];
  }

  bool parallel_;
  const ClippedTriangle* part_;
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
  slot_of_pixel_.clear();
  pattern_ = kCentre;
  clear(static_cast<std::size_t>(width_) * static_cast<std::size_t>(last_row - first_row));
}

void BandRasterizer::begin_edges(const RasterScene& scene, const TriangleBins& bins, int first_row,
                                 int last_row, std::span<const std::uint8_t> wanted,
                                 std::span<const SubPixel> pattern) {
  begin(scene, bins, first_row, last_row);
  slot_of_pixel_.assign(wanted.size(), kNone);
  pattern_ = pattern;
  std::uint32_t slots = 0;
  for (std::size_t pixel = 0; pixel < wanted.size(); ++pixel) {
    if (wanted[pixel] == 0) continue;
    slot_of_pixel_[pixel] = slots;
    slots += static_cast<std::uint32_t>(pattern.size());
  }
  clear(slots);
}

void BandRasterizer::clear(std::size_t slots) {
  const bool any_opaque = std::any_of(scene_->surfaces.begin(), scene_->surfaces.end(),
                                      [](const SurfaceDraw& surface) { return surface.opacity >= 1; });
  nearest_.assign(any_opaque ? slots : 0, Crossing{});
  crossings_.clear();
  end_of_slot_.assign(slots, 0);
}

void BandRasterizer::draw(const TriangleRef& ref) {
  const auto& corners = scene_->surfaces[ref.surface].mesh->triangles[ref.triangle];
  const std::span<const ScreenVertex> vertices = bins_->vertices(ref.surface);
  const Triangle t(ref, ref.part == nullptr
                            ? std::array{vertices[corners[0]], vertices[corners[1]], vertices[corners[2]]}
                            : std::array{snapped(ref.part->corner[0]), snapped(ref.part->corner[1]),
                                         snapped(ref.part->corner[2])});
  if (t.area == 0) return;
  if (slot_of_pixel_.empty()) {
    sample_centers(t);
  } else {
    sample_patterns(t);
  }
}

void BandRasterizer::sample_centers(const Triangle& t) {
  const PixelBox box = clipped(pixels_of(t.corner[0], t.corner[1], t.corner[2], 0));
  const EdgeWalk walk(t, box.x_first, box.y_first);
  std::optional<Attributes> attributes;
  for (std::int32_t y = box.y_first; y <= box.y_last; ++y) {
    EdgeWalk::Edges edges = walk.row(y - box.y_first);
    const auto slot = static_cast<std::uint32_t>((y - first_row_) * width_);
    for (std::int32_t x = box.x_first; x <= box.x_last; ++x, walk.step(edges)) {
      if (!EdgeWalk::inside(edges)) continue;
      if (!attributes) {
        if (is_hidden(t, slot + static_cast<std::uint32_t>(x))) continue;
        attributes.emplace(*scene_, t.ref);
      }
      add(t, *attributes, slot + static_cast<std::uint32_t>(x), t.weights(edges), attributes->depth_at(x, y));
    }
  }
}

void BandRasterizer::sample_patterns(const Triangle& t) {
  const PixelBox box = clipped(pixels_of(t.corner[0], t.corner[1], t.corner[2], kHalfPixel));
  const EdgeWalk walk(t, box.x_first, box.y_first);
  std::optional<Attributes> attributes;
  for (std::int32_t y = box.y_first; y <= box.y_last; ++y) {
    EdgeWalk::Edges at_center = walk.row(y - box.y_first);
    const std::uint32_t* const slots = &slot_of_pixel_[static_cast<std::size_t>((y - first_row_) * width_)];
    for (std::int32_t x = box.x_first; x <= box.x_last; ++x, walk.step(at_center)) {
      if (slots[x] == kNone || walk.misses_pixel(at_center)) continue;
      for (std::uint32_t n = 0; n < pattern_.size(); ++n) {
        const EdgeWalk::Edges edges = walk.moved(at_center, pattern_[n]);
        if (!EdgeWalk::inside(edges)) continue;
        if (!attributes) {
          if (is_hidden(t, slots[x] + n)) continue;
          attributes.emplace(*scene_, t.ref);
        }
        add(t, *attributes, slots[x] + n, t.weights(edges),
            attributes->depth_at(x + pattern_[n].x / kSubPixels, y + pattern_[n].y / kSubPixels));
      }
    }
  }
}

/// All of the triangle is behind an opaque surface there. Looked at before anything is worked out for it.
bool BandRasterizer::is_hidden(const Triangle& t, std::uint32_t slot) const {
  if (nearest_.empty() || nearest_[slot].surface == kNone) return false;
  const SurfaceMesh& mesh = *scene_->surfaces[t.ref.surface].mesh;
  const auto& corners = mesh.triangles[t.ref.triangle];
  const auto depth = [&](std::size_t n) {
    return static_cast<float>(scene_->depth_sign) * mesh.positions_ijk[corners[n]][scene_->depth_axis];
  };
  const float nearest = nearest_[slot].depth;
  return std::min({depth(0), depth(1), depth(2)}) > nearest + kSurelyBehind + std::abs(nearest) * kRounding;
}

PixelBox BandRasterizer::clipped(PixelBox box) const {
  return {std::max(box.x_first, 0), std::min(box.x_last, width_ - 1), std::max(box.y_first, first_row_),
          std::min(box.y_last, last_row_ - 1)};
}

bool BandRasterizer::in_front(const Crossing& a, const Crossing& b) const {
  if (a.order != b.order) return a.order < b.order;
  const StructureIndex of_a = scene_->surfaces[a.surface].structure;
  const StructureIndex of_b = scene_->surfaces[b.surface].structure;
  return of_a != of_b ? of_a < of_b : a.triangle < b.triangle;
}

void BandRasterizer::add(const Triangle& triangle, const Attributes& attributes, std::uint32_t slot,
                         std::array<float, 3> weight, double depth) {
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
      attributes.correct(weight);
      crossing.light = {weight[1], weight[2]};
      nearest = crossing;
      return;
    }
  }
  attributes.correct(weight);
  const SurfaceLight light = lit(*surface.mesh, triangle.ref.triangle, attributes.front(), weight);
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

void BandRasterizer::finish(float transmittance_floor, BandFragments& out, std::span<SurfacesSeen> seen) {
  take_opaque();
  sort_by_slot();
  out.fragments.resize(crossings_.size());
  out.end_of_slot.resize(end_of_slot_.size());
  std::uint32_t kept = 0;
  std::uint32_t begin = 0;
  for (std::size_t slot = 0; slot < end_of_slot_.size(); ++slot) {
    const auto of_slot = std::span(order_).subspan(begin, end_of_slot_[slot] - begin);
    begin = end_of_slot_[slot];
    sort_slot(of_slot);
    SurfacesSeen sum;
    float through = 1;
    for (const std::uint32_t n : of_slot) {
      if (through <= transmittance_floor) break;
      const Crossing& crossing = sorted_[n];
      const Fragment& last = out.fragments[kept++] = fragment(crossing);
      if (!seen.empty()) {
        const auto side = (crossing.surface << 1) | static_cast<std::uint32_t>(crossing.order & 1);
        sum.add(side, through, last);
      }
      through *= 1 - last.rgba[3];
    }
    out.end_of_slot[slot] = kept;
    if (!seen.empty()) seen[slot] = sum;
  }
  out.fragments.resize(kept);
}

Fragment BandRasterizer::fragment(const Crossing& crossing) const {
  const SurfaceDraw& surface = scene_->surfaces[crossing.surface];
  const SurfaceLight light{crossing.light[0], crossing.light[1]};
  Fragment fragment{crossing.depth, {0, 0, 0, surface.opacity}, surface.structure};
  for (std::size_t c = 0; c < 3; ++c) fragment.rgba[c] = light.on(surface.color[c]) * surface.opacity;
  return fragment;
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

/// A counting sort.
void BandRasterizer::sort_by_slot() {
  std::fill(end_of_slot_.begin(), end_of_slot_.end(), 0);
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

/// Insertion: a slot has few crossings, often in order already.
void BandRasterizer::sort_slot(std::span<std::uint32_t> of_slot) const {
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

#include "player/render/surfaces/band_rasterizer.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace splatlas {
namespace {

/// Surfaces coincide if their depths lie in the same bin of 1/4096 voxel. The offset moves bin limits away
/// from common surface depths such as half voxels, where rounding would decide.
constexpr double kDepthSteps = 4096;
constexpr double kDepthOffset = 0.3183;
/// Margins of the occlusion test, in voxels and relative to the depth, above bin width and rounding.
constexpr float kSurelyBehind = 2 / 4096.0f;
constexpr float kRounding = 0x1p-22f;
/// Sides of faces of cuts in SurfacesSeen::add().
constexpr std::uint32_t kFaceSide = 0x80000000;
constexpr double kDepthBias = 0x1p40;  // bins; exceeds the depth of any grid, so that all bins are positive

}  // namespace

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
  const ScreenTriangle t(
      ref, ref.part == nullptr ? std::array{vertices[corners[0]], vertices[corners[1]], vertices[corners[2]]}
                               : std::array{snapped(ref.part->corner[0]), snapped(ref.part->corner[1]),
                                            snapped(ref.part->corner[2])});
  if (t.area == 0) return;
  cuts_ = bins_->meets_cut(ref.surface, corners) ? scene_->cuts : nullptr;
  if (slot_of_pixel_.empty()) {
    sample_centers(t);
  } else {
    sample_patterns(t);
  }
}

void BandRasterizer::sample_centers(const ScreenTriangle& t) {
  const PixelBox box = intersection(pixels_of(t.corner[0], t.corner[1], t.corner[2], 0), band());
  const EdgeWalk walk(t, box.x_first, box.y_first);
  std::optional<TriangleAttributes> attributes;
  for (std::int32_t y = box.y_first; y <= box.y_last; ++y) {
    EdgeWalk::Edges edges = walk.row(y - box.y_first);
    const auto slot = static_cast<std::uint32_t>((y - first_row_) * width_);
    for (std::int32_t x = box.x_first; x <= box.x_last; ++x, walk.step(edges)) {
      if (!EdgeWalk::inside(edges)) continue;
      if (!attributes) {
        if (is_hidden(t, slot + static_cast<std::uint32_t>(x))) continue;
        attributes.emplace(*scene_, t.ref);
      }
      const double depth = attributes->depth_at(x, y);
      if (cuts_ != nullptr && is_cut_away(x, y, depth)) continue;
      add(t, *attributes, slot + static_cast<std::uint32_t>(x), t.weights(edges), depth);
    }
  }
}

void BandRasterizer::sample_patterns(const ScreenTriangle& t) {
  const PixelBox box = intersection(pixels_of(t.corner[0], t.corner[1], t.corner[2], kHalfPixel), band());
  const EdgeWalk walk(t, box.x_first, box.y_first);
  std::optional<TriangleAttributes> attributes;
  for (std::int32_t y = box.y_first; y <= box.y_last; ++y) {
    EdgeWalk::Edges at_center = walk.row(y - box.y_first);
    const std::uint32_t* const slots = slot_of_pixel_.data() + std::ptrdiff_t{y - first_row_} * width_;
    for (std::int32_t x = box.x_first; x <= box.x_last; ++x, walk.step(at_center)) {
      if (slots[x] == kNone || walk.misses_pixel(at_center)) continue;
      for (std::uint32_t n = 0; n < pattern_.size(); ++n) {
        const EdgeWalk::Edges edges = walk.moved(at_center, pattern_[n]);
        if (!EdgeWalk::inside(edges)) continue;
        if (!attributes) {
          if (is_hidden(t, slots[x] + n)) continue;
          attributes.emplace(*scene_, t.ref);
        }
        const double sample_x = x + pattern_[n].x / kSubPixels, sample_y = y + pattern_[n].y / kSubPixels;
        const double depth = attributes->depth_at(sample_x, sample_y);
        if (cuts_ != nullptr && is_cut_away(sample_x, sample_y, depth)) continue;
        add(t, *attributes, slots[x] + n, t.weights(edges), depth);
      }
    }
  }
}

/// True if the whole triangle is behind the opaque surface of the slot. A test of vertex depths, before the
/// set-up of attributes.
bool BandRasterizer::is_hidden(const ScreenTriangle& t, std::uint32_t slot) const {
  if (nearest_.empty() || nearest_[slot].surface == kNone) return false;
  const SurfaceMesh& mesh = *scene_->surfaces[t.ref.surface].mesh;
  const auto& corners = mesh.triangles[t.ref.triangle];
  const auto depth = [&](std::size_t n) {
    return static_cast<float>(scene_->depth_sign) * mesh.positions_ijk[corners[n]][scene_->depth_axis];
  };
  const float nearest = nearest_[slot].depth;
  return std::min({depth(0), depth(1), depth(2)}) > nearest + kSurelyBehind + std::abs(nearest) * kRounding;
}

bool BandRasterizer::is_cut_away(double x, double y, double depth) const {
  const ClipDepths kept = cuts_->depths(x + 0.5, y + 0.5, scene_->depth_axis, scene_->depth_sign);
  return !(depth >= kept.from && depth <= kept.to);
}

bool BandRasterizer::in_front(const Crossing& a, const Crossing& b) const {
  if (a.order != b.order) return a.order < b.order;
  const StructureIndex of_a = scene_->surfaces[a.surface].structure;
  const StructureIndex of_b = scene_->surfaces[b.surface].structure;
  return of_a != of_b ? of_a < of_b : a.triangle < b.triangle;
}

void BandRasterizer::add(const ScreenTriangle& triangle, const TriangleAttributes& attributes,
                         std::uint32_t slot, std::array<float, 3> weight, double depth) {
  // Quantise the depth into the sort key
  const SurfaceDraw& surface = scene_->surfaces[triangle.ref.surface];
  Crossing crossing;
  const double step = std::floor(depth * kDepthSteps + kDepthOffset) + kDepthBias;
  crossing.order = (static_cast<std::uint64_t>(step) << 1) | (attributes.front() ? 1 : 0);
  crossing.slot = slot;
  crossing.depth = static_cast<float>(depth);
  crossing.surface = triangle.ref.surface;
  crossing.triangle = triangle.ref.triangle;

  // Test against the nearest opaque crossing; opaque surfaces are shaded later
  if (!nearest_.empty()) {
    Crossing& nearest = nearest_[slot];
    if (nearest.surface != kNone && !in_front(crossing, nearest)) return;
    if (surface.opacity >= 1) {
      attributes.correct(weight);
      crossing.shading = {weight[1], weight[2]};
      nearest = crossing;
      return;
    }
  }

  // Shade a translucent crossing
  attributes.correct(weight);
  const SurfaceShading shading = shade(*surface.mesh, triangle.ref.triangle, attributes.front(), weight);
  crossing.shading = {shading.diffuse, shading.highlight};
  crossings_.push_back(crossing);
}

SurfaceShading BandRasterizer::shade(const SurfaceMesh& mesh, std::uint32_t triangle, bool front,
                                     const std::array<float, 3>& weight) const {
  const auto& corners = mesh.triangles[triangle];
  std::array<float, 3> normal{};
  for (std::size_t n = 0; n < 3; ++n) {
    for (std::size_t c = 0; c < 3; ++c) normal[c] += weight[n] * mesh.normals_lps[corners[n]][c];
  }
  if (!front) normal = {-normal[0], -normal[1], -normal[2]};
  return scene_->lighting.on_surface(normal);
}

void BandRasterizer::finish(float termination_threshold, BandFragments& out, std::span<SurfacesSeen> seen,
                            const SlotFaces& faces) {
  // Shade the visible opaque crossings and sort all by slot
  take_opaque();
  sort_by_slot();

  // Composite each slot front to back until the termination threshold
  out.fragments.resize(crossings_.size());
  out.end_of_slot.resize(end_of_slot_.size());
  std::uint32_t kept = 0;
  std::uint32_t begin = 0;
  for (std::size_t slot = 0; slot < end_of_slot_.size(); ++slot) {
    const auto of_slot = std::span(order_).subspan(begin, end_of_slot_[slot] - begin);
    begin = end_of_slot_[slot];
    sort_slot(of_slot);
    SurfacesSeen sum;
    float transmittance = 1;
    const auto pass_face = [&](const Face& face) {
      if (face.shows() && transmittance > termination_threshold)
        sum.add(kFaceSide | face.structure, transmittance, {face.depth, face.rgba, face.structure});
      transmittance *= 1 - face.rgba[3];
    };
    if (!faces.front.empty()) pass_face(faces.front[slot]);
    for (const std::uint32_t n : of_slot) {
      if (transmittance <= termination_threshold) break;
      const Crossing& crossing = sorted_[n];
      const Fragment& last = out.fragments[kept++] = fragment(crossing);
      if (!seen.empty()) {
        const auto side = (crossing.surface << 1) | static_cast<std::uint32_t>(crossing.order & 1);
        sum.add(side, transmittance, last);
      }
      transmittance *= 1 - last.rgba[3];
    }
    if (!faces.back.empty()) pass_face(faces.back[slot]);
    out.end_of_slot[slot] = kept;
    if (!seen.empty()) seen[slot] = sum;
  }
  out.fragments.resize(kept);
}

Fragment BandRasterizer::fragment(const Crossing& crossing) const {
  const SurfaceDraw& surface = scene_->surfaces[crossing.surface];
  const SurfaceShading shading{crossing.shading[0], crossing.shading[1]};
  Fragment fragment{crossing.depth, {0, 0, 0, surface.opacity}, surface.structure};
  for (std::size_t c = 0; c < 3; ++c) fragment.rgba[c] = shading.on(surface.color[c]) * surface.opacity;
  return fragment;
}

void BandRasterizer::take_opaque() {
  for (const Crossing& nearest : nearest_) {
    if (nearest.surface == kNone) continue;
    const auto [second, third] = nearest.shading;
    const SurfaceShading shading = shade(*scene_->surfaces[nearest.surface].mesh, nearest.triangle,
                                         (nearest.order & 1) != 0, {1 - second - third, second, third});
    crossings_.push_back(nearest);
    crossings_.back().shading = {shading.diffuse, shading.highlight};
  }
}

/// Counting sort.
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

/// Insertion sort: a slot has few crossings, which are often in order.
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

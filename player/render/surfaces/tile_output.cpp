#include <algorithm>
#include <utility>

#include "player/render/surfaces/tile_rasterizer.h"

namespace splatlas {
namespace {

/// Sides of faces of cuts in SurfacesSeen::add().
constexpr std::uint32_t kFaceSide = 0x80000000;

}  // namespace

bool TileRasterizer::in_front(const Crossing& a, const Crossing& b) const {
  if (a.order != b.order) return a.order < b.order;
  const SurfaceDraw& of_a = scene_->surfaces[a.surface];
  const SurfaceDraw& of_b = scene_->surfaces[b.surface];
  if (of_a.structure != of_b.structure) return of_a.structure < of_b.structure;
  return of_a.clusters->number(a.triangle) < of_b.clusters->number(b.triangle);
}

std::array<float, 3> TileRasterizer::normal_of(const Crossing& crossing) const {
  const SurfaceClusters& clusters = *scene_->surfaces[crossing.surface].clusters;
  const auto [first, second, third] = clusters.normals(crossing.triangle);
  const auto [second_weight, third_weight] = crossing.weights;
  const float first_weight = 1 - second_weight - third_weight;
  std::array<float, 3> normal{};
  for (std::size_t c = 0; c < 3; ++c)
    normal[c] = first_weight * first[c] + second_weight * second[c] + third_weight * third[c];
  if ((crossing.order & 1) == 0) normal = {-normal[0], -normal[1], -normal[2]};  // the back face
  return normal;
}

Fragment TileRasterizer::fragment(const Crossing& crossing) const {
  const SurfaceDraw& surface = scene_->surfaces[crossing.surface];
  const std::array<float, 3> normal = normal_of(crossing);
  const float opacity =
      surface.ghost ? surface.opacity * ghost_share(scene_->lighting.facing(normal)) : surface.opacity;
  const SurfaceShading shading = surface.ghost ? SurfaceShading{} : scene_->lighting.on_surface(normal);
  Fragment fragment{crossing.depth, {0, 0, 0, opacity}, surface.structure};
  for (std::size_t c = 0; c < 3; ++c) fragment.rgba[c] = shading.on(surface.color[c]) * opacity;
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

void TileRasterizer::paint(float termination_threshold, const PaintedPicture& picture,
                           std::span<SurfacesSeen> seen) {
  if (crossings_.empty() && slot_of_pixel_.empty()) {
    for (std::int32_t y = tile_.y_first; y <= tile_.y_last; ++y) paint_opaque_row(y, picture, seen);
    return;
  }
  sort_by_slot();
  const auto slots = static_cast<std::uint32_t>(pattern_.size());
  const float share = 1 / static_cast<float>(slots);
  for_each_pixel([&](std::size_t pixel, std::uint32_t first_slot) {
    Radiance sum;
    for (std::uint32_t slot = first_slot; slot < first_slot + slots; ++slot)
      sum += finish_slot(slot, {}, termination_threshold, nullptr, seen.empty() ? nullptr : &seen[pixel]);
    for (std::size_t c = 0; c < 4; ++c) picture.rgba[4 * pixel + c] = sum.rgba[c] * share;
  });
}

void TileRasterizer::paint_opaque_row(std::int32_t y, const PaintedPicture& picture,
                                      std::span<SurfacesSeen> seen) const {
  const auto columns = static_cast<std::size_t>(tile_.x_last - tile_.x_first) + 1;
  const std::size_t first = static_cast<std::size_t>(y - tile_.y_first) * kStride;
  const std::size_t pixel = static_cast<std::size_t>(y) * static_cast<std::size_t>(scene_->size.width) +
                            static_cast<std::size_t>(tile_.x_first);
  float* const rgba = &picture.rgba[4 * pixel];
  std::fill_n(rgba, 4 * columns, 0.0f);
  if (!picture.depths.empty()) std::fill_n(&picture.depths[pixel], columns, kNothingHidden);
  if (!seen.empty()) std::fill_n(&seen[pixel], columns, SurfacesSeen{});

  // Interpolate the normals of covered pixels, and light them all together
  std::array<std::uint32_t, kStride> covered;
  std::array<std::array<float, kStride>, 3> normals;
  std::array<float, kStride> diffuse, highlight;
  std::size_t count = 0;
  for (std::size_t x = 0; x < columns; ++x) {
    if (!has_nearest(first + x)) continue;
    const std::array<float, 3> normal = normal_of(nearest_[first + x]);
    for (std::size_t c = 0; c < 3; ++c) normals[c][count] = normal[c];
    covered[count++] = static_cast<std::uint32_t>(x);
  }
  scene_->lighting.on_surfaces(count, {normals[0].data(), normals[1].data(), normals[2].data()},
                               diffuse.data(), highlight.data());
  for (std::size_t n = 0; n < count; ++n) {
    const std::size_t x = covered[n];
    const Crossing& nearest = nearest_[first + x];
    const std::array<float, 3>& color = scene_->surfaces[nearest.surface].color;
    const SurfaceShading shading{diffuse[n], highlight[n]};
    for (std::size_t c = 0; c < 3; ++c) rgba[4 * x + c] = shading.on(color[c]);
    rgba[4 * x + 3] = 1;
    if (!picture.depths.empty()) picture.depths[pixel + x] = nearest.depth;
    if (seen.empty()) continue;
    seen[pixel + x].add(side_of(nearest), 1,
                        {nearest.depth, {rgba[4 * x], rgba[4 * x + 1], rgba[4 * x + 2], 1}, kNoStructure});
  }
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
  const auto pass = [&](const Crossing& crossing) {
    const Fragment last = fragment(crossing);
    if (out != nullptr) out->push_back(last);
    if (seen != nullptr) seen->add(side_of(crossing), transmittance, last);
    for (std::size_t c = 0; c < 4; ++c) sum.rgba[c] += transmittance * last.rgba[c];
    transmittance *= 1 - last.rgba[3];
  };
  const auto is_behind_its_hull = [&](const SurfaceDraw& surface) {
    if (!surface.ghost) return false;
    const bool is_behind = std::ranges::find(hulls_, *surface.ghost) != hulls_.end();
    if (!is_behind) hulls_.push_back(*surface.ghost);
    return is_behind;
  };
  hulls_.clear();
  pass_face(faces.front);
  if (!end_of_slot_.empty()) {
    const std::uint32_t begin = slot == 0 ? 0 : end_of_slot_[slot - 1];
    const auto of_slot = std::span(order_).subspan(begin, end_of_slot_[slot] - begin);
    sort_slot(of_slot);
    for (const std::uint32_t n : of_slot) {
      if (transmittance <= termination_threshold) break;
      if (!is_behind_its_hull(scene_->surfaces[sorted_[n].surface])) pass(sorted_[n]);
    }
  }
  if (has_nearest(slot) && transmittance > termination_threshold) pass(nearest_[slot]);
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

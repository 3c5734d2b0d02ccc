#include <algorithm>
#include <utility>

#include "player/render/surfaces/tile_rasterizer.h"

namespace splatlas {

void TileRasterizer::pass_all_layers() {
  static_cast<void>(layers_.pass(kNothingHidden));
  for (std::uint32_t slot = 0; slot < depth_.of_slot.size(); ++slot) {
    if (depth_.has(slot) && layers_.is_clear(slot)) layers_.add() = depth_.nearest[slot];
  }
  static_cast<void>(layers_.pass(kNothingHidden));
  for (std::uint32_t slot = 0; slot < faces_.size(); ++slot) layers_.pass_face(slot, faces_[slot].back);
  if (!slot_of_pixel_.empty() || !layers_.has_faces()) return;
  for_each_pixel(
      [&](std::size_t pixel, std::uint32_t slot) { layers_.pass_face(slot, scene_->faces->at(pixel).back); });
}

void TileRasterizer::finish(TileFragments& out) {
  change_hull({});
  pass_all_layers();
  // Counting sort by slot
  out.end_of_slot.assign(depth_.of_slot.size(), 0);
  for (const SlotFragment& of : layers_.fragments()) ++out.end_of_slot[of.slot];
  std::uint32_t begin = 0;
  for (std::uint32_t& end : out.end_of_slot) begin += std::exchange(end, begin);
  out.fragments.resize(begin);
  for (const SlotFragment& of : layers_.fragments()) out.fragments[out.end_of_slot[of.slot]++] = of.fragment;
}

void TileRasterizer::paint(std::vector<float>& rgba, std::vector<float>* depths) {
  change_hull({});
  const bool is_centers = slot_of_pixel_.empty();
  if (is_centers && !layers_.any() && !layers_.has_faces()) {
    for (std::int32_t y = tile_.y_first; y <= tile_.y_last; ++y) paint_opaque_row(y, rgba, depths);
  } else {
    paint_layers(rgba);
  }
  if (depths != nullptr || !is_centers || scene_->faces == nullptr || layers_.has_faces()) return;
  for (std::int32_t y = tile_.y_first; y <= tile_.y_last; ++y)
    scene_->faces->add_to_row(static_cast<std::size_t>(y), tile_.x_first, tile_.x_last + 1,
                              &rgba[4 * scene_->size.pixel(0, y)]);
}

void TileRasterizer::paint_layers(std::vector<float>& rgba) {
  pass_all_layers();
  const auto slots = static_cast<std::uint32_t>(pattern_.size());
  const float share = 1 / static_cast<float>(slots);
  for_each_pixel([&](std::size_t pixel, std::uint32_t first_slot) {
    Radiance sum;
    for (std::uint32_t slot = first_slot; slot < first_slot + slots; ++slot) sum += layers_.radiance(slot);
    for (std::size_t c = 0; c < 4; ++c) rgba[4 * pixel + c] = sum.rgba[c] * share;
  });
}

void TileRasterizer::paint_opaque_row(std::int32_t y, std::vector<float>& picture,
                                      std::vector<float>* depths) const {
  const auto columns = static_cast<std::size_t>(tile_.x_last - tile_.x_first) + 1;
  const std::size_t first = static_cast<std::size_t>(y - tile_.y_first) * kStride;
  const std::size_t pixel = scene_->size.pixel(tile_.x_first, y);
  float* const rgba = &picture[4 * pixel];
  std::fill_n(rgba, 4 * columns, 0.0f);
  for (std::size_t n = pixel; depths != nullptr && n < pixel + columns; ++n) {
    const bool is_hidden = scene_->faces != nullptr && scene_->faces->hides(n);
    (*depths)[n] = is_hidden ? scene_->faces->front()[n].depth : kNothingHidden;
  }

  // Interpolate the normals of covered pixels, and light them all together
  std::array<std::uint32_t, kStride> covered;
  std::array<std::array<float, kStride>, 3> normals;
  std::array<float, kStride> diffuse, highlight;
  std::size_t count = 0;
  for (std::size_t x = 0; x < columns; ++x) {
    if (!depth_.has(first + x)) continue;
    for (std::size_t c = 0; c < 3; ++c) normals[c][count] = depth_.nearest[first + x].normal_lps[c];
    covered[count++] = static_cast<std::uint32_t>(x);
  }
  scene_->lighting.on_surfaces(count, {normals[0].data(), normals[1].data(), normals[2].data()},
                               diffuse.data(), highlight.data());
  for (std::size_t n = 0; n < count; ++n) {
    const std::size_t x = covered[n];
    const Crossing& nearest = depth_.nearest[first + x];
    const std::array<float, 3>& color = scene_->surfaces[nearest.surface()].color;
    const SurfaceShading shading{diffuse[n], highlight[n]};
    for (std::size_t c = 0; c < 3; ++c) rgba[4 * x + c] = shading.on(color[c]);
    rgba[4 * x + 3] = 1;
    if (depths != nullptr) (*depths)[pixel + x] = static_cast<float>(nearest.depth);
    if (seen_.empty()) continue;
    seen_[scene_->region.place(tile_.x_first, y) + x].add(nearest.side, 1,
                                                          {static_cast<float>(nearest.depth),
                                                           {rgba[4 * x], rgba[4 * x + 1], rgba[4 * x + 2], 1},
                                                           kNoStructure});
  }
}

}  // namespace splatlas

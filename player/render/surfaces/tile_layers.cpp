#include "player/render/surfaces/tile_layers.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "format/tasks/task_control.h"

namespace splatlas {
namespace {

constexpr std::size_t kRowsPerChunk = 16;

float max_difference(const std::array<float, 4>& a, const std::array<float, 4>& b) {
  float max = 0;
  for (std::size_t c = 0; c < 4; ++c) max = std::max(max, std::abs(a[c] - b[c]));
  return max;
}

/// Crossings that wait at least, and fit the L2 cache. Where many surfaces overlap in depth, more wait.
constexpr std::size_t kDue = 4096;
/// Crossings that are lit together.
constexpr std::size_t kBatch = 128;
/// Sides of faces of cuts in SurfacesSeen::add().
constexpr std::uint32_t kFaceSide = 0x80000000;

}  // namespace

void SurfacesSeen::add(std::uint32_t side, float transmittance, const Fragment& fragment) {
  constexpr std::uint32_t kHashFactor = 0x9e3779b1;  // 2^32 over the golden ratio
  if (radiance.rgba[3] == 0) depth = fragment.depth;
  const std::uint32_t hash = (side + 1) * kHashFactor;
  const float share = transmittance * fragment.rgba[3];
  for (std::size_t c = 0; c < 4; ++c) {
    radiance.rgba[c] += transmittance * fragment.rgba[c];
    layers[c] += share * static_cast<float>((hash >> (8 * c)) & 0xff) * (1.0f / 255);
  }
}

void find_edge_pixels(std::span<const SurfacesSeen> seen, const PictureSize& size, float pixel_voxels,
                      std::vector<std::uint8_t>& edges, ThreadPool& pool) {
  const auto edge_between = [max_depth = kEdgeSlope * pixel_voxels](const SurfacesSeen& a,
                                                                    const SurfacesSeen& b) {
    const bool differ =
        max_difference(a.layers, b.layers) > kEdgeLayers || std::abs(a.depth - b.depth) > max_depth;
    return differ && max_difference(a.radiance.rgba, b.radiance.rgba) > kEdgeContrast;
  };
  const auto width = static_cast<std::size_t>(size.width);
  const auto height = static_cast<std::size_t>(size.height);
  edges.assign(width * height, 0);
  pool.for_each((height + kRowsPerChunk - 1) / kRowsPerChunk, [&](std::size_t chunk) {
    const std::size_t first = chunk * kRowsPerChunk;
    for (std::size_t row = first; row < std::min(first + kRowsPerChunk, height); ++row) {
      const SurfacesSeen* here = &seen[row * width];
      std::uint8_t* const edge = &edges[row * width];
      for (std::size_t x = 1; x < width; ++x) {
        if (edge_between(here[x - 1], here[x])) edge[x - 1] = edge[x] = 1;
      }
      // Test both vertical neighbours, so that a chunk writes only to its own rows
      const SurfacesSeen* const above = row > 0 ? here - width : nullptr;
      const SurfacesSeen* const below = row + 1 < height ? here + width : nullptr;
      for (std::size_t x = 0; x < width; ++x) {
        if (above != nullptr && edge_between(here[x], above[x])) edge[x] = 1;
        if (below != nullptr && edge_between(here[x], below[x])) edge[x] = 1;
      }
    }
  });
}

bool in_front(const Crossing& a, const Crossing& b, const RasterScene& scene) {
  const double bin_of_a = depth_bin(a.depth), bin_of_b = depth_bin(b.depth);
  if (bin_of_a != bin_of_b) return bin_of_a < bin_of_b;
  if ((a.side & 1) != (b.side & 1)) return (a.side & 1) < (b.side & 1);
  const SurfaceDraw& of_a = scene.surfaces[a.surface()];
  const SurfaceDraw& of_b = scene.surfaces[b.surface()];
  if (of_a.structure != of_b.structure) return of_a.structure < of_b.structure;
  return of_a.clusters->number(a.triangle) < of_b.clusters->number(b.triangle);
}

void TileLayers::begin(const RasterScene& scene, const PixelBox& tile, std::size_t slots,
                       const TileOptions& options) {
  scene_ = &scene;
  tile_ = tile;
  options_ = options;
  any_ = false;
  has_ghosts_ =
      std::ranges::any_of(scene.surfaces, [](const SurfaceDraw& of) { return of.ghost.has_value(); });
  radiances_.assign(slots, {});
  transmittances_.assign(slots, 1);
  first_.assign(slots, kNone);
  hull_.clear();
  hulls_.clear();
  due_ = kDue;
  waiting_.clear();
  fragments_.clear();
}

void TileLayers::pass_face(std::uint32_t slot, const Face& face) {
  float& transmittance = transmittances_[slot];
  if (!options_.seen.empty() && face.shows() && is_clear(slot))
    seen(slot).add(kFaceSide | face.structure, transmittance, {face.depth, face.rgba, face.structure});
  for (std::size_t c = 0; c < 4; ++c) radiances_[slot].rgba[c] += transmittance * face.rgba[c];
  transmittance *= 1 - face.rgba[3];
}

std::span<const std::uint32_t> TileLayers::pass(float depth) {
  ended_.clear();
  // Those of earlier bins; one bin less, as rounding may place the depth behind it
  const double end = depth_bin(static_cast<double>(depth)) - 1;
  const auto behind = std::partition(waiting_.begin(), waiting_.end(), [end](const Crossing& crossing) {
    return in_bins(crossing.depth) < end;
  });
  any_ |= behind != waiting_.begin();
  sort_slots(static_cast<std::uint32_t>(behind - waiting_.begin()));
  for (std::size_t n = 0; n < sequence_.size(); n += kBatch)
    composite(std::span(sequence_).subspan(n, std::min(kBatch, sequence_.size() - n)));
  waiting_.erase(waiting_.begin(), behind);
  due_ = std::max(kDue, 2 * waiting_.size());
  return ended_;
}

/// Makes the sequence of the first `count` crossings, without those that are hidden.
void TileLayers::sort_slots(std::uint32_t count) {
  next_.resize(count);
  for (std::uint32_t n = count; n-- > 0;) next_[n] = std::exchange(first_[waiting_[n].slot], n);
  sequence_.clear();
  for (std::uint32_t n = 0; n < count; ++n) {
    const std::uint32_t slot = waiting_[n].slot;
    if (first_[slot] != n) continue;  // taken with an earlier one
    first_[slot] = kNone;
    if (!is_clear(slot)) continue;
    if (next_[n] == kNone) {
      take(n);
    } else {
      sort_chain(n);
    }
  }
}

/// Sorts the crossings of a slot into the sequence.
void TileLayers::sort_chain(std::uint32_t first) {
  chain_.clear();
  for (std::uint32_t n = first; n != kNone; n = next_[n]) chain_.push_back(n);
  std::ranges::sort(chain_, [this](std::uint32_t a, std::uint32_t b) {
    return in_front(waiting_[a], waiting_[b], *scene_);
  });
  for (const std::uint32_t n : chain_) take(n);
}

void TileLayers::take(std::uint32_t crossing) {
  if (has_ghosts_) {
    const std::optional<std::uint32_t>& ghost = scene_->surfaces[waiting_[crossing].surface()].ghost;
    if (ghost && !enters_hull(waiting_[crossing].slot, *ghost)) return;
  }
  sequence_.push_back(crossing);
}

/// False if the slot has passed the hull of this ghost.
bool TileLayers::enters_hull(std::uint32_t slot, std::uint32_t ghost) {
  if (hull_.empty()) hull_.assign(transmittances_.size(), kNone);
  for (std::uint32_t n = hull_[slot]; n != kNone; n = hulls_[n].before) {
    if (hulls_[n].ghost == ghost) return false;
  }
  hulls_.push_back({ghost, hull_[slot]});
  hull_[slot] = static_cast<std::uint32_t>(hulls_.size() - 1);
  return true;
}

void TileLayers::composite(std::span<const std::uint32_t> crossings) {
  check_task();
  std::array<std::array<float, kBatch>, 3> normals;
  std::array<float, kBatch> diffuse, highlight;
  for (std::size_t n = 0; n < crossings.size(); ++n) {
    for (std::size_t c = 0; c < 3; ++c) normals[c][n] = waiting_[crossings[n]].normal_lps[c];
  }
  scene_->lighting.on_surfaces(crossings.size(), {normals[0].data(), normals[1].data(), normals[2].data()},
                               diffuse.data(), highlight.data());
  for (std::size_t n = 0; n < crossings.size(); ++n) {
    const Crossing& crossing = waiting_[crossings[n]];
    if (!is_clear(crossing.slot)) continue;
    const SurfaceDraw& surface = scene_->surfaces[crossing.surface()];
    Radiance& radiance = radiances_[crossing.slot];
    float& transmittance = transmittances_[crossing.slot];
    SurfaceShading shading{diffuse[n], highlight[n]};
    float opacity = surface.opacity;
    if (surface.ghost) {
      shading = {};
      opacity *= ghost_share(scene_->lighting.facing(crossing.normal_lps));
    }
    Fragment fragment{static_cast<float>(crossing.depth), {0, 0, 0, opacity}, surface.structure};
    for (std::size_t c = 0; c < 3; ++c) fragment.rgba[c] = shading.on(surface.color[c]) * opacity;
    if (options_.keeps_fragments) fragments_.push_back({crossing.slot, fragment});
    if (!options_.seen.empty()) seen(crossing.slot).add(crossing.side, transmittance, fragment);
    for (std::size_t c = 0; c < 4; ++c) radiance.rgba[c] += transmittance * fragment.rgba[c];
    transmittance *= 1 - opacity;
    if (!is_clear(crossing.slot)) ended_.push_back(crossing.slot);
  }
}

}  // namespace splatlas

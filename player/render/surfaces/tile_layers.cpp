#include "player/render/surfaces/tile_layers.h"

#include <algorithm>
#include <optional>
#include <tuple>
#include <utility>

#include "format/tasks/task_control.h"

namespace splatlas {
namespace {

constexpr std::int32_t kRowsPerChunk = 16;

bool differ(const std::array<float, 4>& a, const std::array<float, 4>& b, float by) {
  bool any = false;
  for (std::size_t c = 0; c < 4; ++c) any |= std::abs(a[c] - b[c]) > by;
  return any;
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

void SurfacesSeen::add(const Face& face, float transmittance) {
  if (face.shows()) add(kFaceSide | face.structure, transmittance, {face.depth, face.rgba, face.structure});
}

void find_edge_pixels(const SeenRow& seen, const PictureSize& size, float pixel_voxels,
                      std::vector<std::uint8_t>& edges, ThreadPool& pool) {
  const auto edge_between = [max_depth = kEdgeSlope * pixel_voxels](const SurfacesSeen& a,
                                                                    const SurfacesSeen& b) {
    return (differ(a.layers, b.layers, kEdgeLayers) || std::abs(a.depth - b.depth) > max_depth) &&
           differ(a.radiance.rgba, b.radiance.rgba, kEdgeContrast);
  };
  const auto width = static_cast<std::size_t>(size.width);
  edges.assign(size.pixels(), 0);
  const std::int32_t chunks = (size.height + kRowsPerChunk - 1) / kRowsPerChunk;
  pool.for_each(static_cast<std::size_t>(chunks), [&](std::size_t chunk) {
    const std::int32_t first = static_cast<std::int32_t>(chunk) * kRowsPerChunk;
    std::array<std::vector<SurfacesSeen>, 3> rooms;
    const auto row_at = [&](std::int32_t y) {
      return y < 0 || y >= size.height ? nullptr : seen(y, rooms[static_cast<std::size_t>(y + 1) % 3]);
    };
    const SurfacesSeen* above = row_at(first - 1);
    const SurfacesSeen* here = row_at(first);
    for (std::int32_t y = first; y < first + kRowsPerChunk && here != nullptr; ++y) {
      const SurfacesSeen* const below = row_at(y + 1);
      std::uint8_t* const edge = &edges[size.pixel(0, y)];
      for (std::size_t x = 1; x < width; ++x) {
        if (edge_between(here[x - 1], here[x])) edge[x - 1] = edge[x] = 1;
      }
      // Test both vertical neighbours, so that a chunk writes only to its own rows
      for (std::size_t x = 0; x < width; ++x) {
        if (above != nullptr && edge_between(here[x], above[x])) edge[x] = 1;
        if (below != nullptr && edge_between(here[x], below[x])) edge[x] = 1;
      }
      above = std::exchange(here, below);
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
  radiances_.assign(slots, {});
  transmittances_.assign(slots, 1);
  first_.assign(slots, kNone);
  due_ = kDue;
  waiting_.clear();
  fragments_.clear();
}

void TileLayers::pass_face(std::uint32_t slot, const Face& face) {
  float& transmittance = transmittances_[slot];
  if (!options_.seen.empty() && is_clear(slot)) seen(slot).add(face, transmittance);
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
      sequence_.push_back(n);
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
  sequence_.insert(sequence_.end(), chain_.begin(), chain_.end());
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

namespace {

constexpr std::uint32_t kClustersPerJob = 512;
/// Padding of boxes in pixels, above snapping and the reach of sampling patterns.
constexpr double kPad = 1;

std::array<float, 3> corner_of(const SurfaceClusters::Box& box, unsigned corner) {
  std::array<float, 3> p{};
  for (std::size_t a = 0; a < 3; ++a) p[a] = (corner >> a & 1) != 0 ? box.high[a] : box.low[a];
  return p;
}

/// Pixels of a region that may show a box: none behind the near plane, all if the box meets that plane.
PixelBox pixels_of(const SurfaceClusters::Box& box, const Projection& projection, const PixelBox& region) {
  double left = HUGE_VAL, right = -HUGE_VAL, top = HUGE_VAL, bottom = -HUGE_VAL;
  unsigned behind = 0;
  for (unsigned corner = 0; corner < 8; ++corner) {
    const ScreenPoint point = projection.homogeneous(corner_of(box, corner));
    if (!(point.w >= kNearPlane)) {
      ++behind;
      continue;
    }
    left = std::min(left, point.x / point.w);
    right = std::max(right, point.x / point.w);
    top = std::min(top, point.y / point.w);
    bottom = std::max(bottom, point.y / point.w);
  }
  if (behind == 8) return {};
  if (behind > 0) return region;
  const auto pixel = [](double at, std::int32_t first, std::int32_t last) {
    return static_cast<std::int32_t>(std::clamp(std::floor(at), first - 1.0, last + 1.0));
  };
  return intersection(region, {pixel(left - kPad, region.x_first, region.x_last),
                               pixel(right + kPad, region.x_first, region.x_last),
                               pixel(top - kPad, region.y_first, region.y_last),
                               pixel(bottom + kPad, region.y_first, region.y_last)});
}

/// False if one plane removes the box; true if a plane may remove a part of it.
std::optional<bool> is_cut(const SurfaceClusters::Box& box, const CutRays* cuts) {
  if (cuts == nullptr) return false;
  unsigned any = 0, all = 0xff;
  for (unsigned corner = 0; corner < 8; ++corner) {
    const unsigned removing = cuts->removing(corner_of(box, corner));
    any |= removing;
    all &= removing;
  }
  if (all != 0) return std::nullopt;
  return any != 0;
}

}  // namespace

PixelBox TileBins::box(std::size_t tile) const {
  const std::int32_t x = region_.x_first + static_cast<std::int32_t>(tile % columns_) * kTileSide;
  const std::int32_t y = region_.y_first + static_cast<std::int32_t>(tile / columns_) * kTileSide;
  return intersection(region_, {x, x + kTileSide - 1, y, y + kTileSide - 1});
}

void TileBins::place(const RasterScene& scene, std::uint32_t surface, std::uint32_t cluster,
                     std::vector<Placed>& out) const {
  const SurfaceClusters::Box& box = (*scene.surfaces[surface].clusters)[cluster].box;
  if (box.low[0] > box.high[0] || box.low[1] > box.high[1] || box.low[2] > box.high[2]) return;
  PixelBox pixels = pixels_of(box, scene.projection, region_);
  if (pixels.empty()) return;
  pixels = {pixels.x_first - region_.x_first, pixels.x_last - region_.x_first,
            pixels.y_first - region_.y_first, pixels.y_last - region_.y_first};
  const std::optional<bool> cut = is_cut(box, scene.cuts);
  if (!cut) return;
  const auto sign = static_cast<float>(scene.depth_sign);
  const float nearest = std::min(sign * box.low[scene.depth_axis], sign * box.high[scene.depth_axis]);
  const auto block = [](std::int32_t pixel, std::int32_t tile) {
    const std::int32_t first = tile * kTileSide;
    return static_cast<std::uint8_t>(std::clamp(pixel - first, 0, kTileSide - 1) / kBlockSide);
  };
  for (std::int32_t y = pixels.y_first / kTileSide; y <= pixels.y_last / kTileSide; ++y) {
    for (std::int32_t x = pixels.x_first / kTileSide; x <= pixels.x_last / kTileSide; ++x) {
      const std::size_t tile = static_cast<std::size_t>(y) * columns_ + static_cast<std::size_t>(x);
      out.push_back({static_cast<std::uint32_t>(tile),
                     {nearest, surface, cluster, *cut, block(pixels.x_first, x), block(pixels.x_last, x),
                      block(pixels.y_first, y), block(pixels.y_last, y)}});
    }
  }
}

void TileBins::fill(const RasterScene& scene, ThreadPool& pool) {
  const auto tiles_of = [](int pixels) {
    return (static_cast<std::size_t>(pixels) + kTileSide - 1) / kTileSide;
  };
  region_ = scene.region;
  rows_ = tiles_of(region_.height());
  columns_ = tiles_of(region_.width());

  // Place clusters
  struct Job {
    std::uint32_t surface, first, last;
  };
  std::vector<Job> jobs;
  for (std::uint32_t s = 0; s < scene.surfaces.size(); ++s) {
    const auto clusters = static_cast<std::uint32_t>(scene.surfaces[s].clusters->size());
    for (std::uint32_t first = 0; first < clusters; first += kClustersPerJob)
      jobs.push_back({s, first, std::min(first + kClustersPerJob, clusters)});
  }
  of_job_.resize(jobs.size());
  pool.for_each(jobs.size(), [&](std::size_t n) {
    of_job_[n].clear();
    for (std::uint32_t c = jobs[n].first; c < jobs[n].last; ++c) place(scene, jobs[n].surface, c, of_job_[n]);
  });

  // Sort them by tile, by counting, and by depth within each tile
  first_of_tile_.assign(tiles() + 2, 0);
  for (const std::vector<Placed>& of : of_job_) {
    for (const Placed& placed : of) ++first_of_tile_[placed.tile + 2];
  }
  for (std::size_t n = 2; n < first_of_tile_.size(); ++n) first_of_tile_[n] += first_of_tile_[n - 1];
  clusters_.resize(first_of_tile_.back());
  for (const std::vector<Placed>& of : of_job_) {
    for (const Placed& placed : of) clusters_[first_of_tile_[placed.tile + 1]++] = placed.cluster;
  }
  const auto key = [&scene](const TileCluster& of) {
    const SurfaceDraw& surface = scene.surfaces[of.surface];
    const std::uint64_t group = surface.is_opaque() ? 0 : surface.ghost ? 1UL + *surface.ghost : ~0UL;
    return std::tuple(group, of.nearest, of.surface, of.cluster);
  };
  pool.for_each(tiles(), [&](std::size_t tile) {
    std::sort(clusters_.begin() + static_cast<std::ptrdiff_t>(first_of_tile_[tile]),
              clusters_.begin() + static_cast<std::ptrdiff_t>(first_of_tile_[tile + 1]),
              [&](const TileCluster& a, const TileCluster& b) { return key(a) < key(b); });
  });
}

}  // namespace splatlas

#include "player/render/surfaces/tile_bins.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>

namespace splatlas {
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
    return std::tuple(!scene.surfaces[of.surface].is_opaque(), of.nearest, of.surface, of.cluster);
  };
  pool.for_each(tiles(), [&](std::size_t tile) {
    std::sort(clusters_.begin() + static_cast<std::ptrdiff_t>(first_of_tile_[tile]),
              clusters_.begin() + static_cast<std::ptrdiff_t>(first_of_tile_[tile + 1]),
              [&](const TileCluster& a, const TileCluster& b) { return key(a) < key(b); });
  });
}

}  // namespace splatlas

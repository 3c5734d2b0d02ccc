#include "player/render/rays/ray_depths.h"

#include <algorithm>
#include <cmath>

#include "format/tasks/task_control.h"
#include "player/render/rays/cast_rays.h"
#include "player/render/rays/pixel_rays.h"

namespace splatlas {
namespace {

constexpr float kOpacity = 0.5f;  // at the depth of a ray
constexpr float kSlabsAtOnce = 8;
constexpr int kBisections = 4;  // to half a slab

using PerRay = std::array<float, kPacketRays>;

/// Clips rays to the grid.
void clip_to_grid(const MarchGrid& grid, RayPacket& rays) {
  for (std::size_t n = 0; n < kPacketRays; ++n) {
    for (std::size_t a = 0; a < 3; ++a) {
      if (std::abs(rays.step[a][n]) < 1e-12f) continue;
      const float one = -rays.origin[a][n] / rays.step[a][n];
      const float other = (static_cast<float>(grid.size[a]) - rays.origin[a][n]) / rays.step[a][n];
      rays.from[n] = std::max(rays.from[n], std::min(one, other));
      rays.to[n] = std::min(rays.to[n], std::max(one, other));
    }
    if (!(rays.from[n] < rays.to[n])) rays.from[n] = rays.to[n] = 0;
  }
}

/// Positions t along the rays of a packet at which they reach the opacity, to about a tenth of a slab.
/// Marches a few slabs at a time, and bisects the slabs in which rays reach it.
class DepthSearch {
 public:
  DepthSearch(const MarchScene& scene, const RayPacket& rays, const MarchKernels& kernels)
      : scene_(scene), rays_(rays), kernels_(kernels) {
    clip_to_grid(scene.grid, rays_);
    found_.fill(DepthMap::kBackground);
  }

  /// kBackground for rays that stay below the opacity. Cost: linear in the volume along the rays.
  PerRay run() {
    const PerRay ends = rays_.to;
    PerRay at = rays_.from;
    RadiancePacket radiance;
    while (true) {
      PerRay next = at;
      bool any = false;
      for (std::size_t n = 0; n < kPacketRays; ++n) {
        if (found_[n] != DepthMap::kBackground) continue;
        next[n] = std::min(ends[n], at[n] + kSlabsAtOnce);
        any = any || at[n] < next[n];
      }
      if (!any) return found_;
      const RadiancePacket before = radiance;
      march(at, next, radiance);
      narrow(at, next, before, radiance);
      at = next;
    }
  }

 private:
  void march(const PerRay& from, const PerRay& to, RadiancePacket& radiance) {
    rays_.from = from;
    rays_.to = to;
    kernels_.march(scene_, rays_, radiance);
  }

  /// Bisects the interval of rays that reach the opacity between `from` and `to`.
  void narrow(PerRay from, PerRay to, RadiancePacket before, RadiancePacket behind) {
    std::array<bool, kPacketRays> crosses{};
    bool any = false;
    for (std::size_t n = 0; n < kPacketRays; ++n) {
      crosses[n] = from[n] < to[n] && behind.planes[3][n] >= kOpacity;
      any = any || crosses[n];
      if (!crosses[n]) to[n] = from[n];
    }
    if (!any) return;
    for (int bisection = 0; bisection < kBisections; ++bisection) {
      PerRay middle = from;
      for (std::size_t n = 0; n < kPacketRays; ++n) middle[n] = 0.5f * (from[n] + to[n]);
      RadiancePacket radiance = before;
      march(from, middle, radiance);
      for (std::size_t n = 0; n < kPacketRays; ++n) {
        const bool in_front = radiance.planes[3][n] >= kOpacity;
        (in_front ? to : from)[n] = middle[n];
        for (std::size_t c = 0; c < 4; ++c) (in_front ? behind : before).planes[c][n] = radiance.planes[c][n];
      }
    }
    for (std::size_t n = 0; n < kPacketRays; ++n) {
      if (!crosses[n]) continue;
      const float rise = behind.planes[3][n] - before.planes[3][n];
      const float share = rise > 0 ? (kOpacity - before.planes[3][n]) / rise : 0.5f;
      found_[n] = from[n] + std::clamp(share, 0.0f, 1.0f) * (to[n] - from[n]);
    }
  }

  const MarchScene& scene_;
  RayPacket rays_;
  const MarchKernels& kernels_;
  PerRay found_{};
};

}  // namespace

void add_ray_depths(const RayVolume& volume, const View& view, const Grid& grid, const MarchKernels& kernels,
                    const CutRays* cuts, const ViewDepth& view_depth, DepthMap& depths, ThreadPool& pool) {
  if (volume.empty()) return;
  const PixelRays pixel_rays(view, grid, volume.first(), std::nullopt);
  const MarchScene scene = march_scene(volume, {});
  const int width = depths.size.width;
  const auto bands = static_cast<std::size_t>((depths.size.height + kBlockSide - 1) / kBlockSide);
  pool.for_each(bands, [&](std::size_t band) {
    const int top = static_cast<int>(band) * kBlockSide;
    for (int left = 0; left < width; left += kBlockSide) {
      check_task();
      const RayPoints points = RayBlock{left, top}.points(0, depths.size);
      const auto& [x, y] = points;
      RayPacket rays = pixel_rays.through(points);
      if (cuts != nullptr) pixel_rays.clip(*cuts, points, rays);
      const PerRay places = DepthSearch(scene, rays, kernels).run();
      for (std::size_t n = 0; n < kPacketRays; ++n) {
        if (places[n] == DepthMap::kBackground) continue;
        const std::size_t axis = principal_axis_of(rays, n);
        const double index =
            static_cast<double>(rays.step[axis][n] * places[n]) + static_cast<double>(volume.first()[axis]);
        float& mm = depths.mm[static_cast<std::size_t>(y[n]) * static_cast<std::size_t>(width) +
                              static_cast<std::size_t>(x[n])];
        mm = std::min(mm, static_cast<float>(view_depth.mm(x[n], y[n], axis, index)));
      }
    }
  });
}

}  // namespace splatlas

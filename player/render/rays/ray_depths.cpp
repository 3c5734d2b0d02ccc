#include "player/render/rays/ray_depths.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "format/tasks/task_control.h"
#include "player/render/rays/cast_rays.h"
#include "player/render/rays/pixel_rays.h"

namespace splatlas {
namespace {

constexpr float kOpacity = 0.5f;  // at the depth of a ray
constexpr float kOpaque = 1e-6f;  // rounding error of a transmittance

using PerRay = std::array<float, kPacketRays>;

/// Positions t along the rays of a packet at which they reach the opacity.
struct DepthTrace : MarchTrace {
  PerRay found{}, seen{};  // seen: opacity so far

  DepthTrace() {
    found.fill(DepthMap::kBackground);
    take = [](MarchTrace& trace) { static_cast<DepthTrace&>(trace).take_steps(); };
  }
  void take_steps() {
    for (std::size_t n = 0; n < count; ++n) {
      for (std::size_t ray = 0; ray < kPacketRays; ++ray) {
        const float before = std::exchange(seen[ray], steps[n].opacity[ray]), behind = seen[ray];
        if (before >= kOpacity || behind < kOpacity) continue;
        // The extinction within a step counts as constant
        const float transmittance = std::max(1 - behind, kOpaque);
        const float share = std::log((1 - before) / kOpacity) / std::log((1 - before) / transmittance);
        found[ray] = steps[n].from[ray] + share * (steps[n].to[ray] - steps[n].from[ray]);
      }
    }
    count = 0;
  }
};

}  // namespace

void add_ray_depths(const RayVolume& volume, const View& view, const Grid& grid, const MarchKernels& kernels,
                    const CutRays* cuts, const ViewDepth& view_depth, DepthMap& depths, ThreadPool& pool) {
  if (volume.empty()) return;
  const PixelRays pixel_rays(view, grid, volume.first(), std::nullopt);
  const MarchScene scene = march_scene(volume, {.termination_threshold = kOpacity});
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
      DepthTrace trace;
      RadiancePacket radiance;
      radiance.trace = &trace;
      kernels.march(scene, rays, radiance);
      trace.take_steps();
      const PerRay& places = trace.found;
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

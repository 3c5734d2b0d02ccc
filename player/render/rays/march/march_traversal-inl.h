// Traversal of a volume by a packet of rays, the hot loop. Compiled once for every instruction set.
#if defined(SPLATLAS_PLAYER_MARCH_TRAVERSAL_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SPLATLAS_PLAYER_MARCH_TRAVERSAL_INL_H_
#undef SPLATLAS_PLAYER_MARCH_TRAVERSAL_INL_H_
#else
#define SPLATLAS_PLAYER_MARCH_TRAVERSAL_INL_H_
#endif

#include <cmath>
#include <cstddef>
#include <cstdint>

#include <hwy/highway.h>

#include "player/render/rays/march/march_multi_appearance-inl.h"
#include "player/render/rays/march/march_optics-inl.h"
#include "player/render/rays/march/march_packet-inl.h"
#include "player/render/rays/march/march_single_appearance-inl.h"
#include "player/render/rays/march_kernels.h"

HWY_BEFORE_NAMESPACE();
namespace splatlas::HWY_NAMESPACE {

/// True if any brick that the packet may cross from t0 to t1 is active. Stores the box of those bricks.
HWY_INLINE bool AnyWithin(const MarchScene& scene, const Bounds& bounds, float t0, float t1,
                          std::int32_t* from, std::int32_t* to) {
  bounds.Bricks(scene.grid, t0, t1, from, to);
  return AnyActive(scene.active, scene.grid, from, to);
}

/// Marches a packet front to back with empty-space skipping and early ray termination.
template <typename Appearance>
void March(const MarchScene& scene, const Rays& rays, Accumulated& accumulated) {
  const Lanes d;
  const auto counts = rays.Counts();
  if (AllFalse(d, counts)) return;

  // Find the batches of slabs between the first entry and the last exit of the packet.
  constexpr auto kBatch = static_cast<float>(kSlabs);
  constexpr float kSkip = 4 * kBatch;
  const auto never = Set(d, 1e9f);
  const float enter = MinLane(d, IfThenElse(counts, rays.from, never));
  const float leave = MaxLane(d, IfThenElse(counts, rays.to, Neg(never)));
  const float first = std::floor(enter / kBatch) * kBatch;
  const float last = std::ceil(leave / kBatch) * kBatch;
  const Bounds bounds(rays, counts, first, last);

  Appearance appearance(scene, rays, accumulated);
  float skip_from = first;  // an active brick lies within kSkip before this
  for (float t = first; t < last; t += kBatch) {
    std::int32_t from[3], to[3];
    if (!AnyWithin(scene, bounds, t, t + kBatch, from, to)) {
      // Skip empty space, several batches at a time.
      appearance.Invalidate();
      if (t < skip_from) continue;
      float next = t + kBatch;
      while (next < last && !AnyWithin(scene, bounds, next, next + kSkip, from, to)) next += kSkip;
      skip_from = next + kSkip;
      t = next - kBatch;
      continue;
    }
    appearance.MarchBatch(t, from, to);
    // Terminate the packet once every ray is nearly opaque.
    const auto opaque = Le(accumulated.Transmittance(), Set(d, scene.termination_threshold));
    if (AllTrue(d, Or(opaque, Not(counts)))) break;
  }
  appearance.Finish();
}

inline void MarchPacket(const MarchScene& scene, const RayPacket& packet, RadiancePacket& radiance) {
  const Lanes d;
  const Rays rays(scene.grid, packet);
  Accumulated accumulated;
  accumulated.trace = radiance.trace;
  for (std::size_t c = 0; c < 3; ++c) accumulated.color[c] = Load(d, radiance.planes[c].data());
  accumulated.opacity = Load(d, radiance.planes[3].data());
  const MarchSource& source = scene.sources[0];
  const bool single = scene.sources.size() == 1 && source.cell_corners != nullptr && source.colors == nullptr;
  if (single && ShortTransfer::fits(*source.transfer)) {
    March<SingleAppearance<ShortTransfer>>(scene, rays, accumulated);
  } else if (single) {
    March<SingleAppearance<LongTransfer>>(scene, rays, accumulated);
  } else {
    March<MultiAppearance>(scene, rays, accumulated);
  }
  for (std::size_t c = 0; c < 3; ++c) Store(accumulated.color[c], d, radiance.planes[c].data());
  Store(accumulated.opacity, d, radiance.planes[3].data());
}

}  // namespace splatlas::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // SPLATLAS_PLAYER_MARCH_TRAVERSAL_INL_H_

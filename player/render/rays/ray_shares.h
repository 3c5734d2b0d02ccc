// Shares of structures in the opacity of rays, and their depths.
#pragma once

#include <array>
#include <cstddef>

#include "player/picture.h"
#include "player/render/contributions/pixel_shares.h"
#include "player/render/rays/march_kernels.h"
#include "player/render/rays/volume/ray_volume.h"

namespace splatlas {

/// Shares of structures along the rays of a packet, and where each ray reaches half opacity. The opacity of a
/// step belongs to the structures of the eight voxels around its middle: in proportion to their extinctions
/// with pre-classification, and to the trilinear weights with post-classification. Not thread-safe.
class RayShares {
 public:
  /// `volume` must outlive the shares. Without structure numbers, it has depths alone.
  explicit RayShares(const RayVolume& volume);
  RayShares(const RayShares&) = delete;
  RayShares& operator=(const RayShares&) = delete;

  /// Begins with the rays of another packet. `rays` must outlive it; its interval may change.
  void begin(const RayPacket& rays);
  /// For RadiancePacket::trace.
  [[nodiscard]] MarchTrace* trace() { return &trace_; }
  /// Adds the steps of the last call of MarchKernels::march().
  void take();
  /// Adds a fragment, which has been composited: `opacity` is that of the ray behind it.
  void add_fragment(std::size_t ray, StructureIndex structure, float opacity);

  [[nodiscard]] const PixelShares& of_ray(std::size_t ray) const { return shares_[ray]; }
  /// The t at which the volume along a ray reaches an opacity of one half; infinite if it does not.
  [[nodiscard]] float depth_of_ray(std::size_t ray) const { return depths_[ray]; }

 private:
  struct Trace : MarchTrace {
    RayShares* owner = nullptr;
  };
  void add(std::size_t ray, float rise, float t);

  const RayVolume& volume_;
  const float* extinctions_ = nullptr;        // of voxels, every fourth float; null: post-classified
  const StructureNumber* numbers_ = nullptr;  // of voxels
  const StructureNumber* cells_ = nullptr;
  std::array<std::size_t, 8> corners_{};  // offsets of the voxels around a cell
  const RayPacket* rays_ = nullptr;
  std::array<float, kPacketRays> seen_{};  // opacity so far
  std::array<PixelShares, kPacketRays> shares_;
  std::array<float, kPacketRays> depths_{};
  Trace trace_;
};

}  // namespace splatlas

// HOT LOOP: rays through the volume, side by side, chosen once per frame for the machine.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "player/transfer/preintegrated_transfer.h"

namespace splatlas {

/// Rays that march together.
inline constexpr std::size_t kPacketRays = 16;
/// Sources that one selection may have.
inline constexpr std::size_t kMaxSources = 64;

/// Where rays march: the box around the selected voxels with two more on every side, in which nothing is.
/// Positions are counted in voxels from its first one. Cells lie between eight voxels; bricks are kBrick^3
/// cells.
struct MarchGrid {
  static constexpr std::int32_t kBrick = 4;
  std::array<std::int32_t, 3> size{};  ///< voxels, the margin included

  [[nodiscard]] std::int32_t bricks(std::size_t axis) const { return (size[axis] + kBrick - 1) / kBrick; }
};

/// What rays sample: one of octants, greys and light is set.
struct MarchSource {
  /// Classified after interpolation. The grey values of a cell's eight voxels, a byte each, x fastest.
  const std::uint64_t* cell_corners = nullptr;
  const float* greys = nullptr;                  ///< the same for values that are no bytes: one per voxel
  const PreintegratedTransfer* curve = nullptr;  ///< of both
  std::array<float, 3> color{};                  ///< of both, where there are no colours
  const float* colors = nullptr;                 ///< per voxel: red, green, blue, 1; all 0 where nothing is
  /// Classified before interpolation. Per voxel: extinction, and emission in red, green and blue, 1/mm.
  const float* light = nullptr;
  /// Bricks in which something is visible, as a summed-area table: (bricks + 1)^3 counts, x fastest.
  const std::uint32_t* active = nullptr;
};

struct MarchScene {
  MarchGrid grid;
  std::span<const MarchSource> sources;
  const std::uint32_t* active = nullptr;  ///< of all sources together
  float floor = 0;                        ///< rays that let through no more are ended
  int min_steps = 1, max_steps = 1;       ///< per slab
  float tolerance = 0;                    ///< of a step; 0: always the least
};

/// Rays as straight lines: at `t` a ray is at origin + t * step. Where t is a whole number it is in a plane
/// of voxels normal to the axis along which it passes most of them.
struct RayPacket {
  alignas(64) std::array<std::array<float, kPacketRays>, 3> origin{};
  alignas(64) std::array<std::array<float, kPacketRays>, 3> step{};
  alignas(64) std::array<float, kPacketRays> mm_per_t{};
  alignas(64) std::array<float, kPacketRays> from{}, to{};  ///< what of a ray counts; from >= to: nothing
};

/// Light along rays: red, green, blue (premultiplied, linear), opacity.
struct RadiancePacket {
  alignas(64) std::array<std::array<float, kPacketRays>, 4> planes{};
};

struct MarchKernels {
  const char* name;  ///< "scalar", or the instruction set

  /// Adds the light along the rays behind what `light` holds. Grey values (or light) are trilinear between
  /// voxels and taken at both ends of each step, linear in between: extinction and emission of a step are the
  /// transfer function's means over the grey values from one end to the other, so that the error falls with
  /// the square of the steps, also for steps in the transfer function. Each step's colour is composited
  /// exactly where it is linear in the share of the step's optical depth. A slab, the way from one plane of
  /// voxels to the next, is cut as march_tolerance.h says, or evenly: into as many steps as keep
  ///   (what is seen through) * (its length) * (what the extinction varies by among the voxels around)
  /// below kEvenShare * `tolerance` times n^1.5, for the rays of a vector together. Cost: the samples in
  /// bricks that show something and are not hidden.
  void (*march)(const MarchScene& scene, const RayPacket& rays, RadiancePacket& light);
};

/// Plain C++, ray by ray, the twin that others are compared with. Passes over nothing.
[[nodiscard]] const MarchKernels& scalar_march();
/// The best that this machine runs. Where the tolerance is 0 it agrees with the scalar twin to about 1e-5,
/// and to the floor, but where the twin's own picture hangs on the last place of the view: grey values on a
/// step of their transfer function do that, and colours of `MarchSource::colors` of next to no weight. Else
/// rays of a vector take the steps that any of them needs, and wide vectors are more exact than narrow ones:
/// they are within 4 tolerances of the twin's, and 0.1 in RMS over many. SPLATLAS_SIMD=scalar in the
/// environment forces the twin.
[[nodiscard]] const MarchKernels& best_march();

}  // namespace splatlas

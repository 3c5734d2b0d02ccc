// Ray marching kernels (hot loop): packets of rays through a volume, and their step control.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "player/render/transfer/transfer_table.h"

namespace splatlas {

/// Rays of a packet. They share the choice of steps, empty-space skipping and early ray termination.
inline constexpr std::size_t kPacketRays = 16;
/// Sources of one selection.
inline constexpr std::size_t kMaxSources = 64;

/// Bounding box of the selected voxels, padded by two empty voxels. Positions are counted in voxels from its
/// first voxel. A cell lies between eight voxels; a brick (macrocell) has kBrick^3 cells.
struct MarchGrid {
  static constexpr std::int32_t kBrick = 4;
  std::array<std::int32_t, 3> size{};  ///< voxels, padding included

  [[nodiscard]] std::int32_t bricks(std::size_t axis) const { return (size[axis] + kBrick - 1) / kBrick; }
};

/// A field that rays sample. One of cell_corners, greys and optics is set.
struct MarchSource {
  /// Post-classified: byte grey values of the eight corners of each cell, x fastest.
  const std::uint64_t* cell_corners = nullptr;
  /// Post-classified: one value per voxel. Without `transfer`: its extinction, 1/mm.
  const float* greys = nullptr;
  const PreintegratedTransfer* transfer = nullptr;  ///< of post-classified sources
  std::array<float, 3> color{};                     ///< of post-classified sources without `colors`
  const float* colors = nullptr;  ///< per voxel: red, green, blue, 1; all 0 for absent voxels
  /// Pre-classified. Per voxel: extinction, and emission in red, green and blue, 1/mm.
  const float* optics = nullptr;
  /// Non-empty bricks as a summed-area table (Crow 1984): (bricks + 1)^3 counts, x fastest.
  const std::uint32_t* active = nullptr;
};

struct MarchScene {
  MarchGrid grid;
  std::span<const MarchSource> sources;
  const std::uint32_t* active = nullptr;  ///< non-empty bricks of all sources
  float termination_threshold = 0;        ///< rays stop once their transmittance falls to this value
  int min_steps = 1, max_steps = 1;       ///< per slab
  float tolerance = 0;                    ///< error bound of a step; 0: always min_steps
};

/// Rays as straight lines: at `t` a ray is at origin + t * step, in single precision, rounded once. The plane
/// of voxels at position p along the principal axis (the axis along which the ray crosses most voxels) is
/// reached at t = p or t = -p.
struct RayPacket {
  alignas(64) std::array<std::array<float, kPacketRays>, 3> origin{};
  alignas(64) std::array<std::array<float, kPacketRays>, 3> step{};
  alignas(64) std::array<float, kPacketRays> mm_per_t{};
  alignas(64) std::array<float, kPacketRays> from{}, to{};  ///< interval to integrate; empty if from >= to
};

/// Opacity of a packet's rays behind each step, for shares of structures and depths.
struct MarchTrace {
  struct Step {
    alignas(64) std::array<float, kPacketRays> from, to;  ///< t of the ends of the step
    alignas(64) std::array<float, kPacketRays> opacity;   ///< behind the step
  };
  static constexpr std::size_t kSteps = 32;

  std::array<Step, kSteps> steps;
  std::size_t count = 0;
  /// Takes the steps and sets `count` to 0. Kernels call it when the trace is full, the caller at the end.
  void (*take)(MarchTrace& trace) = nullptr;
};

/// Radiance along rays: red, green, blue (premultiplied, linear), opacity.
struct RadiancePacket {
  alignas(64) std::array<std::array<float, kPacketRays>, 4> planes{};
  MarchTrace* trace = nullptr;  ///< null: none; it changes no radiance
};

struct MarchKernels {
  const char* name;  ///< "scalar", or the instruction set

  /// Composites the radiance along the rays behind `radiance`. Grey values (or optical properties) are
  /// trilinear between voxels, sampled at both ends of each step and linear in between. Extinction and
  /// emission of a step are pre-integrated over the grey values from one end to the other (Engel et al.
  /// 2001). So the error is second order in the step size, or of order 3/2 at discontinuities of the transfer
  /// function. A step's colour is exact if linear in the share of its optical depth.
  ///
  /// A slab is the space between two planes of voxels. It is integrated as SlabMethod defines, or in n
  /// equal steps. n is the smallest number for which all rays of the packet satisfy
  ///   transmittance * segment length * (max - min extinction over the cells it crosses)
  ///     <= kEvenShare * tolerance * n^1.5.
  /// Cost: the samples in non-empty bricks that are not hidden.
  void (*march)(const MarchScene& scene, const RayPacket& rays, RadiancePacket& radiance);
};

/// Scalar reference kernel. SPLATLAS_SIMD=scalar in the environment forces it.
[[nodiscard]] MarchKernels scalar_march();
/// The best kernel that this machine runs. Every instruction set and the scalar reference compute the same
/// operations, rounded alike, for the same packets: results agree to 2e-5 of full scale in all scenes. They
/// are the same bits where the machine has fused multiply-add, and nearly always elsewhere.
[[nodiscard]] MarchKernels best_march();

/// True if slabs are subdivided by cells, not evenly: for byte grey values with one transfer function, as
/// long as one step per slab is allowed.
[[nodiscard]] inline bool subdivides_cells(const MarchScene& scene) {
  return scene.tolerance > 0 && scene.min_steps == 1 && scene.sources.size() == 1 &&
         scene.sources[0].cell_corners != nullptr;
}

/// Integration of a slab, chosen for all rays of a packet together.
enum class SlabMethod : std::uint8_t {
  kLinear,     ///< one step, grey value linear
  kSimpson,    ///< one step, mean grey value by Simpson's rule: the transfer function is nearly linear
  kSubdivide,  ///< cell by cell, the cubic subdivided until it is straight enough
};

// Error bounds of a slab or a part of it, in tolerances. All are multiplied by transmittance, segment length
// and the relevant part of the extinction's variation.
inline constexpr float kMaxVariation = 3;  ///< kSimpson: total variation
inline constexpr float kMaxKinks = 1;      ///< kSimpson: distance from a straight line at the middle
/// Part of a cell: the effect of shifting the grey value by its distance from the chord.
inline constexpr float kMaxShift = 0.7f;
inline constexpr int kMaxSubdivisions = 5;
/// Step with a colour for each voxel: its opacity times the distance of the colour from a straight line.
inline constexpr float kColorShare = 0.2f;
inline constexpr int kMaxHalvings = 3;
/// Opacity up to which the colour in its middle stands for a step, in tolerances.
inline constexpr float kFaintColor = 0.4f;
/// Weight of several slabs, in tolerances, below which one step integrates them all.
inline constexpr float kFaintShare = 0.02f;

/// Lower bound of the sum of the extinctions at both ends of a segment, in mean extinctions of the segment.
/// The slope of the colour along the segment is divided by this sum.
inline constexpr float kMinEnds = 1e-3f;

/// Error bound of a step in a slab that is divided evenly, in tolerances: the field in between is unknown.
inline constexpr float kEvenShare = 0.65f;

/// Simpson's rule: mean height above the chord as a share of the height at the middle.
inline constexpr float kSimpsonShare = 2.0f / 3;

}  // namespace splatlas

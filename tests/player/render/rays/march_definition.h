// Ray marching in equal steps, defined in double precision.
#pragma once

#include <array>
#include <cstddef>

#include "player/render/rays/march_kernels.h"

namespace splatlas::reference {

/// Composites the radiance along ray `n` of a packet behind `rgba`, in `scene.min_steps` equal steps per
/// slab. Written from the model, ray by ray: no packets, no empty-space skipping, no early termination, no
/// tables of integrals. Sample positions are those of the kernels, in single precision; all else in double.
[[nodiscard]] std::array<double, 4> march_definition(const MarchScene& scene, const RayPacket& rays,
                                                     std::size_t n, std::array<double, 4> rgba);

}  // namespace splatlas::reference

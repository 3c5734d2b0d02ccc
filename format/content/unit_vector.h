// Octahedral encoding of unit vectors in 16 bits.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace splatlas {

/// Octahedral map, 8 bits per component, precise rounding (Cigolle et al. 2014, "A Survey of Efficient
/// Representations for Independent Unit Vectors"). Maximum error 0.64 degrees.
using PackedNormal = std::uint16_t;

/// `n` may have any length; zero and non-finite vectors pack as +z.
[[nodiscard]] PackedNormal pack_normal(const std::array<float, 3>& n);
/// The unit vector of a code. All 65 536 codes are valid.
[[nodiscard]] std::array<float, 3> unpack_normal(PackedNormal packed);
/// pack_normal() of each vector. Cost: about 20 ns each.
[[nodiscard]] std::vector<PackedNormal> pack_normals(std::span<const std::array<float, 3>> normals);
/// Replaces each vector by unpack_normal(pack_normal(n)), with the same bits. Cost: about 20 ns each.
void round_normals(std::span<std::array<float, 3>> normals);

}  // namespace splatlas

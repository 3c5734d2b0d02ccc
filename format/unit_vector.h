// Unit vectors in 16 bits.
#pragma once

#include <array>
#include <cstdint>

namespace splatlas {

/// A direction in 16 bits: octahedral map, 8 bits a side (Cigolle et al. 2014, "A Survey of Efficient
/// Representations for Independent Unit Vectors", precise rounding). Largest error 0.64 degrees.
using PackedNormal = std::uint16_t;

/// `n` need not be of unit length; the zero vector packs as +z, and so does one that is not finite.
[[nodiscard]] PackedNormal pack_normal(const std::array<float, 3>& n);
/// Unit length. Every one of the 65 536 codes is a direction.
[[nodiscard]] std::array<float, 3> unpack_normal(PackedNormal packed);

}  // namespace splatlas

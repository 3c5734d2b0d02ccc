// Unit vectors in 16 bits.
#pragma once

#include <array>
#include <cstdint>

namespace splatlas {

/// A direction in 16 bits: octahedral map, 8 bits a side (Cigolle et al. 2014, "A Survey of Efficient
/// Representations for Independent Unit Vectors"). Largest error about 0.9 degrees.
using PackedNormal = std::uint16_t;

/// `n` need not be of unit length; the zero vector packs as +z.
[[nodiscard]] PackedNormal pack_normal(const std::array<float, 3>& n);
[[nodiscard]] std::array<float, 3> unpack_normal(PackedNormal packed);

}  // namespace splatlas

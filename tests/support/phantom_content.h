// Golden phantom as an in-memory atlas, without ITK and VTK.
#pragma once

#include "tests/phantom/two_spheres.h"
#include "tests/support/test_content.h"

namespace splatlas {

/// Structures of phantom_content(). Sphere_1 has two parents.
namespace phantom_structure {
enum Index : StructureIndex { kSpheres, kLarge, kSphere1, kSphere2 };
}  // namespace phantom_structure

/// The voxels of a ball of the phantom.
[[nodiscard]] inline std::vector<bool> phantom_mask(const phantom::Ball& ball) {
  return make_mask({phantom::kSize, phantom::kSize, phantom::kSize},
                   [&](std::int64_t i, std::int64_t j, std::int64_t k) {
                     return ball.holds(static_cast<int>(i), static_cast<int>(j), static_cast<int>(k));
                   });
}

/// Two roots, Spheres/{Sphere_1, Sphere_2} and Large/Sphere_1, over 32x32x32 voxels at (i, j, k) mm LPS.
[[nodiscard]] inline AtlasContent phantom_content() {
  TestVolume volume;
  volume.grid.size = {phantom::kSize, phantom::kSize, phantom::kSize};
  volume.structures = {
      {"Spheres", {}, {200, 200, 200}},
      {"Large", {}, {200, 200, 200}},
      {"Sphere_1",
       phantom_mask(phantom::kBalls[0]),
       {240, 120, 40},
       {phantom_structure::kSpheres, phantom_structure::kLarge}},
      {"Sphere_2", phantom_mask(phantom::kBalls[1]), {80, 140, 250}, {phantom_structure::kSpheres}}};
  volume.values = make_values(VoxelType::kUInt8, phantom::values());
  volume.window_high = 250;
  return make_content(volume);
}

}  // namespace splatlas

// Small random class volumes for property tests.
#pragma once

#include <ostream>
#include <random>
#include <vector>

#include <rapidcheck.h>

#include "format/content/class_table.h"
#include "format/content/grid.h"

namespace splatlas {

struct ClassVolume {
  Index3 size{0, 0, 0};
  std::size_t class_count = 0;
  std::vector<ClassId> classes;
};

inline void showValue(const ClassVolume& v, std::ostream& out) {
  out << v.size[0] << "x" << v.size[1] << "x" << v.size[2] << " of " << v.class_count << " classes:";
  for (const ClassId c : v.classes) out << " " << c;
}

/// A number in [first, last], uniform from the first test case on.
template <typename T>
rc::Gen<T> uniform(T first, T last) {
  return rc::gen::resize(rc::kNominalSize, rc::gen::inRange<T>(first, static_cast<T>(last + 1)));
}

/// A random source for everything else; its seed does not shrink.
inline rc::Gen<std::mt19937> random_source() {
  return rc::gen::map(rc::gen::noShrink(uniform<std::uint32_t>(0, 0x7fffffff)),
                      [](std::uint32_t seed) { return std::mt19937(seed); });
}

/// Below `n`, which is not 0.
inline std::size_t below(std::size_t n, std::mt19937& random) {
  return std::uniform_int_distribution<std::size_t>(0, n - 1)(random);
}

/// Noise, runs that ignore the ends of scanlines, or a checkerboard.
inline std::vector<ClassId> random_classes(const Index3& size, ClassId class_count, std::mt19937& random) {
  const auto below = [&random](ClassId n) {
    return std::uniform_int_distribution<ClassId>(0, n - 1)(random);
  };
  const auto voxels = static_cast<std::size_t>(size[0] * size[1] * size[2]);
  const ClassId kind = below(3);
  std::vector<ClassId> classes;
  while (kind < 2 && classes.size() < voxels) {
    classes.insert(classes.end(), kind == 0 ? 1 : 1 + below(30), below(class_count));
  }
  classes.resize(voxels);
  for (std::size_t n = 0; kind == 2 && n < voxels; ++n) {
    const auto nx = static_cast<std::size_t>(size[0]);
    const auto ny = static_cast<std::size_t>(size[1]);
    classes[n] = static_cast<ClassId>((n % nx + n / nx % ny + n / (nx * ny)) % class_count);
  }
  return classes;
}

/// Sides of 1 are common; sides of several blocks of 16 occur. Shrinks the sides, not the voxels.
inline rc::Gen<ClassVolume> random_class_volume() {
  return rc::gen::exec([] {
    ClassVolume v;
    for (auto& n : v.size) {
      n = *rc::gen::weightedOneOf<std::int64_t>({{1, rc::gen::just<std::int64_t>(1)},
                                                 {3, uniform<std::int64_t>(2, 8)},
                                                 {1, uniform<std::int64_t>(9, 40)}});
    }
    v.class_count = *uniform<std::size_t>(1, 6);
    auto random = *random_source();
    v.classes = random_classes(v.size, static_cast<ClassId>(v.class_count), random);
    return v;
  });
}

}  // namespace splatlas

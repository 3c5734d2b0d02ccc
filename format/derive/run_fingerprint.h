// Fingerprints of voxel sets, for comparing run lists of different axes without decoding them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "format/grid.h"
#include "format/run_model.h"

namespace splatlas {

/// Fingerprint of a set of voxels: a polynomial with the memory offsets of voxels as exponents, evaluated at
/// two fixed points of the prime field of order 2^61 - 1. Two different sets collide with probability at most
/// (voxels / 2^61)^2 (Schwartz-Zippel lemma): below 2^-42 for the largest grids.
using VoxelSetFingerprint = std::array<std::uint64_t, 2>;

/// Computes fingerprints in time linear in the runs, independent of their lengths. Thread-safe.
class RunFingerprinter {
 public:
  explicit RunFingerprinter(const Index3& size);
  /// Fingerprint of valid runs (see validate_runs()) of principal axis `axis`.
  [[nodiscard]] VoxelSetFingerprint of(std::span<const Run> runs, Axis axis) const;

 private:
  /// Table of the powers of one base: four multiplications for any exponent below 2^45.
  class Powers {
   public:
    explicit Powers(std::uint64_t base);
    [[nodiscard]] std::uint64_t of(std::uint64_t exponent) const;

   private:
    static constexpr unsigned kDigitBits = 9, kDigits = 5;
    std::vector<std::uint64_t> table_;  // [digit][value]
  };
  struct Point {
    Powers powers;
    std::array<std::uint64_t, 3> inverse;  // [axis]: 1 / (base^stride - 1)
  };

  Index3 size_, stride_;
  std::vector<Point> points_;
};

}  // namespace splatlas

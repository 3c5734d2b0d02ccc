// Whether two run lists, perhaps of different axes, cover the same voxels: without decoding either to voxels.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "format/grid.h"
#include "format/run_model.h"

namespace splatlas {

/// A fingerprint of a set of voxels: the polynomial whose exponents are the voxels' memory offsets, evaluated
/// at two fixed points of the field of 2^61 - 1 elements. Two different sets agree at one point with a chance
/// of at most voxels / 2^61 (Schwartz and Zippel), at both with its square: below 2^-42 for the largest
/// grids.
using VoxelSetFingerprint = std::array<std::uint64_t, 2>;

/// Computes fingerprints in time and memory of the runs, however many voxels they cover.
class RunFingerprinter {
 public:
  explicit RunFingerprinter(const Index3& size);
  /// `runs` are valid (see validate_runs()) and of principal axis `axis`.
  [[nodiscard]] VoxelSetFingerprint of(std::span<const Run> runs, Axis axis) const;

 private:
  /// Powers of one base, of any exponent below 2^45 with four multiplications.
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

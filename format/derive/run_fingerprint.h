// Fingerprints of voxel sets, for comparing run lists of different axes without decoding them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "format/content/grid.h"
#include "format/content/run_model.h"

namespace splatlas {

/// Fingerprint of a set of voxels: the sum of base^offset over their memory offsets, in the prime field of
/// order 2^61 - 1, with a fixed base (docs/atlas_format.md). Two different sets that arise without regard to
/// the base collide with probability at most voxels / 2^61 (Schwartz-Zippel lemma). No protection against
/// forgery. Disjoint sets: their fingerprints add up.
using VoxelSetFingerprint = std::uint64_t;

/// Sum and difference in the field; both values must be below 2^61 - 1.
[[nodiscard]] VoxelSetFingerprint add_fingerprints(VoxelSetFingerprint a, VoxelSetFingerprint b);
[[nodiscard]] VoxelSetFingerprint subtract_fingerprints(VoxelSetFingerprint a, VoxelSetFingerprint b);
/// True for values of the field.
[[nodiscard]] bool is_fingerprint(std::uint64_t value);

/// Computes fingerprints in time linear in the runs, independent of their lengths. Construction takes time
/// and memory linear in the side lengths of the grid, up to 4096 voxels each, and little beyond. Thread-safe.
class RunFingerprinter {
 public:
  explicit RunFingerprinter(const Index3& size);
  /// Fingerprint of valid runs (see validate_runs()) of principal axis `axis`.
  [[nodiscard]] VoxelSetFingerprint of(std::span<const Run> runs, Axis axis) const;
  /// [class]; the empty class has all voxels that no other class has.
  [[nodiscard]] std::vector<VoxelSetFingerprint> of_classes(const RunModel& model) const;
  /// Fingerprint of all voxels of the grid.
  [[nodiscard]] VoxelSetFingerprint of_grid() const;

 private:
  /// Powers of a step along one axis: base^(stride * n) for n up to the side length.
  class Powers {
   public:
    Powers(std::uint64_t step, std::int64_t side);
    [[nodiscard]] std::uint64_t of(std::uint64_t n) const;
    /// Factor of power differences that gives sums of geometric series: 1 / (step - 1).
    [[nodiscard]] std::uint64_t series_factor() const { return series_factor_; }

   private:
    std::vector<std::uint64_t> low_, high_;
    std::uint64_t series_factor_;
  };

  Index3 size_;
  std::array<Powers, 3> powers_;  // [axis]
};

}  // namespace splatlas

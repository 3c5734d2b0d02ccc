// A transfer function made ready for millions of grey values of one type.
#pragma once

#include <cstddef>
#include <vector>

#include "format/transfer_curve.h"
#include "format/voxel_type.h"

namespace splatlas {

/// A transfer function relative to its densest point. Volumes that differ by their opacity only share it.
struct TransferShape {
  struct Point {
    double grey = 0;
    double extinction = 0;  ///< share of the densest point's, 0 to 1
    double shade = 1;
    friend auto operator<=>(const Point&, const Point&) = default;
  };
  std::vector<Point> points;  ///< as in TransferCurve
  friend auto operator<=>(const TransferShape&, const TransferShape&) = default;
};

/// `curve` is one that check_curve() passes.
[[nodiscard]] TransferShape shape_of(const TransferCurve& curve);

/// What a grey value leaves of a volume at its densest.
struct TransferShare {
  float extinction = 0;
  float shade = 0;
};

/// One voxel's place on a transfer function.
struct ClassifiedVoxel {
  float extinction_per_mm = 0;
  float shade = 0;
};

/// Appearances grey values up. Values of 8 and 16 bits come from a table, made at construction (0.5 MiB for
/// 16 bits), unless there shall be none; others are evaluated one by one. Const members are safe to call from
/// several threads.
class TransferTable {
 public:
  TransferTable(const TransferShape& shape, VoxelType type, bool tabulated = true);

  /// Appearances of `count` values (of the type given at construction): numbers `first`, `first + stride`,
  /// ... of `values`, which is not read when the type is kNone: volumes without grey values are at the last
  /// point. `densest_per_mm`: the extinction at the densest point.
  void look_up(const std::byte* values, std::size_t first, std::size_t stride, std::size_t count,
               float densest_per_mm, ClassifiedVoxel* voxels) const;
  /// The same, apart: extinctions, and extinctions times shades.
  void look_up(const std::byte* values, std::size_t first, std::size_t stride, std::size_t count,
               float densest_per_mm, float* extinctions, float* emissions) const;
  /// NaN counts as lower than all.
  [[nodiscard]] TransferShare share_of(double grey) const;

 private:
  /// Calls take(n, share) for `count` values.
  template <typename Take>
  void for_each_share(const std::byte* values, std::size_t first, std::size_t stride, std::size_t count,
                      const Take& take) const;

  TransferShape shape_;
  VoxelType type_;
  std::vector<TransferShare> table_;  // by the value's bits; empty: evaluate
};

}  // namespace splatlas

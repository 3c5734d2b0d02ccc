// Lookup table of a transfer function for one voxel type.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "format/content/transfer_curve.h"
#include "format/content/voxel_type.h"

namespace splatlas {

/// A transfer function relative to its maximum extinction. Volumes that differ only by opacity share it.
struct TransferShape {
  struct Point {
    double grey = 0;
    double extinction = 0;  ///< share of the maximum, 0 to 1
    double shade = 1;
    friend auto operator<=>(const Point&, const Point&) = default;
  };
  std::vector<Point> points;  ///< as in TransferCurve
  friend auto operator<=>(const TransferShape&, const TransferShape&) = default;
};

/// `curve` must satisfy check_curve().
[[nodiscard]] TransferShape shape_of(const TransferCurve& curve);

/// Extinction, relative to the maximum, and shade of a grey value.
struct TransferShare {
  float extinction = 0;
  float shade = 0;
};

/// A voxel after classification.
struct ClassifiedVoxel {
  float extinction_per_mm = 0;
  float shade = 0;
};

/// Classification of grey values. Values of 8 and 16 bits are looked up in a table (0.5 MiB for 16 bits)
/// unless `tabulated` is false. Other values are evaluated one by one. Const members are thread-safe.
class TransferTable {
 public:
  TransferTable(const TransferShape& shape, VoxelType type, bool tabulated = true);

  /// Classifies `count` elements `first`, `first + stride`, ... of `values`, which have the type given at
  /// construction. `densest_per_mm` is the maximum extinction. Volumes of type kNone have the optical
  /// properties of the last point; `values` is not read.
  void look_up(const std::byte* values, std::size_t first, std::size_t stride, std::size_t count,
               float densest_per_mm, ClassifiedVoxel* voxels) const;
  /// The same with separate outputs: extinctions, and emissions of white (extinction * shade), 1/mm.
  void look_up(const std::byte* values, std::size_t first, std::size_t stride, std::size_t count,
               float densest_per_mm, float* extinctions, float* emissions) const;
  /// The transfer function at `grey`; NaN sorts before all points.
  [[nodiscard]] TransferShare share_of(double grey) const;
  /// The shares of whole grey values from `lowest` to `highest`, by the lower bits of the value; empty if
  /// values are evaluated one by one.
  struct View {
    std::span<const TransferShare> shares;
    float lowest = 0, highest = 0;
  };
  [[nodiscard]] View view() const { return {table_, lowest_, highest_}; }

 private:
  /// Calls take(n, share) for `count` values.
  template <typename Take>
  void for_each_share(const std::byte* values, std::size_t first, std::size_t stride, std::size_t count,
                      const Take& take) const;

  TransferShape shape_;
  VoxelType type_;
  float lowest_ = 0, highest_ = 0;    // values in the table
  std::vector<TransferShare> table_;  // by the value's bits; empty if values are evaluated one by one
};

}  // namespace splatlas

// Surface nets and gradients from runs, for structures that fill little of their bounding box.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "format/derive/part_rows.h"
#include "format/derive/smooth_gradient.h"
#include "format/derive/surface_net.h"

namespace splatlas {

/// surface_net() of a crop of the same voxels: the same bits, in the same order. Stops with nothing once it
/// has more than `max_triangles` or 2^32 - 1 triangles. Cost: n log n for n runs and triangles, with 100
/// bytes per triangle, whatever the size of the bounding box.
[[nodiscard]] std::optional<SurfaceNet> sparse_surface_net(const PartRows& rows, std::uint64_t max_triangles);

/// The gradient of SmoothGradient at any voxel, with the same bits, from the 49 rows around it. Fast if
/// successive voxels are sorted by memory order.
class SparseGradient {
 public:
  /// `rows` must outlive this.
  explicit SparseGradient(const PartRows& rows);
  /// Gradient per voxel along i, j, k. Cost: 200 operations, and a search for 49 rows per change of row.
  [[nodiscard]] std::array<float, 3> at(std::int64_t i, std::int64_t j, std::int64_t k);

 private:
  static constexpr std::int64_t kTaps = GradientKernels::kTaps;
  /// The runs of a row from the first that ends behind the filter.
  struct RowCursor {
    std::span<const PartRun> runs;
    std::size_t next = 0;
  };
  /// Bit t: voxel i - kRadius + t is in the structure.
  [[nodiscard]] static unsigned covered(RowCursor& row, std::int64_t i);
  void go_to_row(std::int64_t j, std::int64_t k);

  const PartRows& rows_;
  const GradientKernels kernels_;
  std::array<float, 1u << kTaps> smooth_{}, derived_{};  // [bits]: a row filtered along i
  std::array<RowCursor, kTaps * kTaps> around_;          // [slice * kTaps + row]
  std::int64_t i_ = 0, j_ = 0, k_ = 0;                   // of the last call
  bool placed_ = false;
};

}  // namespace splatlas

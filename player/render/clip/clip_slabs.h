// Kept fractions of the slabs of a cut sheet, along rows of pixels.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "player/render/clip/cut_rays.h"
#include "player/render/view/shear.h"

namespace splatlas {

/// Kept fraction of a slab along a row of pixels: at_whole + per_pixel * (x - whole) at pixel x, clamped to
/// [0, 1]. Exact near `whole`, where it is between 0 and 1.
struct ClipLine {
  float at_whole = 1, per_pixel = 0;
  std::int32_t whole = 0;
};

/// Pixels of all phase rows of a pair: outside the visible ones the fraction is 0, among the whole ones it
/// is 1. Either may be empty.
struct ClipPixels {
  std::int64_t first_visible = 0, last_visible = 0, first_whole = 0, last_whole = 0;
};

/// Kept fraction of a slab that planes cut: max(0, e + l - 1), with the smallest fraction e of the planes
/// where rays enter, and l of those where they leave. Without planes the slab is whole.
struct ClipRows {
  const ClipPixels* pixels = nullptr;  ///< of each pair
  const ClipLine* lines = nullptr;  ///< of the planes of the first phase row; those of entering planes first
  int entering = 0, planes = 0;
  std::int64_t pair_stride = 0, row_stride = 0, phase_stride = 0;  ///< in lines
};

/// A plane in sheared object space, where points on one ray share (u, v): its distance, in voxels, is
/// at_origin + per_u * u + per_v * v + per_k * k. Removes points at positive distances.
struct ShearedPlane {
  double at_origin = 0, per_u = 0, per_v = 0, per_k = 0;

  ShearedPlane(const VoxelPlane& plane, const Shear& shear);
};

/// Planes of a cut in sheared object space. The kept fraction of a slab at a sheet pixel is
///   max(0, min over entering planes of r + min over leaving planes of r - 1),   r = clamp(1/2 - f / w, 0, 1)
/// with f the distance of the slab's centre from the plane, in voxels. w is the change of f across the slab,
/// which makes the fraction exact. For planes along the view, w is at least the change of f across the pixel
/// less that across a voxel of depth, which antialiases their edges.
class ClipSlabs {
 public:
  /// `margin`: pixels before and after each row of the window whose fractions are defined, too.
  ClipSlabs(std::span<const VoxelPlane> planes, const Shear& shear, const SheetWindow& window,
            std::int64_t margin);

  /// Kept fraction over several rows: 0 everywhere, 1 everywhere, or anything.
  enum class State : std::uint8_t { kRemoved, kCut, kWhole };
  /// Conservative state of fine rows [first_row, last_row) of the slab centred at `k`.
  [[nodiscard]] State state(double k, std::int64_t first_row, std::int64_t last_row) const;

  /// Kept fractions of pairs of voxel rows.
  class Rows;

  /// Voxels [first, last) of row `row` of the slice at `k` whose footprints reach visible pixels of a slab
  /// up to `slack` slices away.
  [[nodiscard]] std::pair<std::int64_t, std::int64_t> visible_voxels(double k, std::int64_t row,
                                                                     double slack = 0) const;

 private:
  /// r before the clamp: at_origin + per_u * u + per_v * v + per_k * k.
  struct Ramp {
    double at_origin = 0, per_u = 0, per_v = 0, per_k = 0;
  };

  const Shear& shear_;
  const SheetWindow& window_;
  std::int64_t margin_;
  std::vector<Ramp> ramps_;  // entering planes first
  int entering_ = 0;
};

class ClipSlabs::Rows {
 public:
  /// Replaces the rows by those of `pairs` pairs of voxel rows from `fine_row` on, with `rows_between` fine
  /// rows each, in all phases, of the slab centred at `k`. Keeps its memory.
  void fill(const ClipSlabs& slabs, double k, std::int64_t fine_row, std::int64_t pairs,
            std::int64_t rows_between);
  [[nodiscard]] State state(std::int64_t pair) const;
  /// Kernel access from a pair and a phase on.
  [[nodiscard]] ClipRows from(std::int64_t pair, std::int64_t phase) const;

 private:
  std::int64_t columns_ = 0, rows_between_ = 1, phases_ = 1;
  int entering_ = 0, planes_ = 0;
  std::vector<ClipPixels> pixels_;
  std::vector<ClipLine> lines_;  // [pair][row between][phase][plane]
};

}  // namespace splatlas

// Slabs of a sheet: slices interpolated for them, and the share of a slab in front of a surface in it.
#pragma once

#include <cstdint>
#include <span>

#include "player/render/sheets/spans/span_model.h"
#include "player/render/sheets/splat/block_runs.h"
#include "player/render/sheets/splat/splat_kernels.h"
#include "player/render/view/shear.h"

namespace splatlas {

/// Slabs across the principal axis, in front-to-back order. With one part, each slice is the centre of a slab
/// one voxel thick. With more parts, each interval between two slices has `parts` slabs of equal thickness.
/// The intervals in front of the first slice and behind the last one count, too.
class Slabs {
 public:
  struct Place {
    std::int32_t slab = 0;
    float part = 0;  ///< share of the slab in front of the depth, [0, 1]
  };

  Slabs(const Shear& shear, const Grid& grid, int parts);

  [[nodiscard]] std::int64_t count() const { return count_; }
  /// Place of a depth along the principal axis, in voxels, growing away from the viewer.
  [[nodiscard]] Place place_of(double depth) const { return at(along_of(depth)); }
  /// The slab that contains position `k` along the principal axis, in voxels of the grid.
  [[nodiscard]] std::int32_t slab_of(double k) const { return place_of(ascending_ ? k : -k).slab; }
  /// Share of the kept part of a slab that is in front of a depth; `from`, `to`: kept depths.
  [[nodiscard]] float kept_part(std::int32_t slab, double depth, double from, double to) const;

 private:
  /// Position in voxels from the slice nearest to the viewer.
  [[nodiscard]] double along_of(double depth) const { return ascending_ ? depth : depth + last_slice_; }
  [[nodiscard]] Place at(double along) const;

  bool ascending_ = true;
  double last_slice_ = 0;
  std::int64_t count_ = 1;
  double begin_ = -0.5;   // of the first slab, in voxels from the slice nearest to the viewer
  double thickness_ = 1;  // in voxels
};

/// Share of a homogeneous slab's radiance that its front `part` contributes. With `absorbed`, the opacity of
/// the whole slab, it is (1 - (1 - absorbed)^part) / absorbed.
[[nodiscard]] float share_of_slab(float absorbed, float part);
/// The same from the accumulated opacities in front of the slab and behind it.
[[nodiscard]] float share_in_slab(float before, float behind, float part);

/// Rows of a slice for a part of a sheet.
struct ShownRows {
  const SliceSpans* slice = nullptr;
  RowRange rows{};               ///< those of `hidden`
  std::vector<Blocks> hidden{};  ///< [row]: blocks without content; they are not seen
};

/// Two neighbouring slices and a position between them. Either is null at the ends of the volume.
struct SlicePair {
  const ShownRows* before = nullptr;
  const ShownRows* behind = nullptr;
  float behind_weight = 0;  ///< 0 at the slice before, 1 at the slice behind
};

/// Interpolates rows of the grid; of each, only the blocks that `visible` names, unless it is empty. `mixed`
/// is overwritten and keeps its capacity. Its spans are the union of both slices' spans, without hidden
/// blocks, voxel counts and lights. Linear in the blocks.
void mix_slices(const SlicePair& pair, const RowRange& rows, std::span<const Blocks> visible,
                const SplatKernels& kernels, SliceSpans& mixed);

}  // namespace splatlas

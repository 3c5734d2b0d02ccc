// Surface and normals derived from the voxels of a structure, so that files need not store them: from a crop,
// or from runs where it fills little of its bounding box.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "format/content/class_table.h"
#include "format/content/grid.h"
#include "format/content/run_model.h"
#include "format/content/surface.h"
#include "format/content/unit_vector.h"
#include "format/derive/smooth_gradient.h"
#include "format/derive/structure_crop.h"
#include "format/derive/surface_net.h"

namespace splatlas {

/// Normals of boundary voxels in LPS: the negative gradient of the smoothed mask (SmoothGradient).
class VoxelNormals {
 public:
  explicit VoxelNormals(const Grid& grid) : to_index_(lps_mm_to_index(grid).linear) {}
  /// `gradient` is per voxel along i, j, k.
  [[nodiscard]] PackedNormal normal(const std::array<float, 3>& gradient) const;
  /// Transforms a gradient by the inverse transpose of the index-to-LPS matrix.
  [[nodiscard]] std::array<float, 3> to_lps(const std::array<float, 3>& gradient) const;

 private:
  Matrix3 to_index_;
};

/// The triangles of a net, turned outwards in LPS, without vertices. Takes them out of the net.
[[nodiscard]] SurfaceMesh triangles_of(SurfaceNet& net, const Grid& grid, SurfaceRule rule);

/// Called with the gradients of each slice k of the crop, in order.
using SliceVisitor = std::function<void(const SmoothGradient& gradient, std::int64_t k)>;

/// Marching cubes (Lorensen and Cline 1987) on the crop of a whole structure, by a rule that the grid admits.
/// The normals of kVoxels apart, they are the directions of smooth(). Otherwise the normal of a vertex is the
/// sum of the smoothed gradients at both ends of its cell edge, or the face normal if that sum points
/// inwards. Normals are rounded to unpack_normal(pack_normal(n)), as in files. `visit_slice` may be empty.
/// Cost: see surface_net() and smooth(); gradients are linear in the voxels of the crop.
[[nodiscard]] SurfaceMesh fit_surface(const StructureCrop& crop, const Grid& grid, SurfaceRule rule,
                                      const SliceVisitor& visit_slice = {});

/// fit_surface() from the structure's runs, with the same bits, or nothing if it has more than
/// `max_triangles` triangles. Cost: see sparse_surface_net(), and about 0.5 us per vertex for gradients.
[[nodiscard]] std::optional<SurfaceMesh> fit_sparse_surface(const PartRows& rows, const Grid& grid,
                                                            SurfaceRule rule, std::uint64_t max_triangles);

/// `box` with all voxels that the normals of its voxels depend on.
[[nodiscard]] IndexBox around(const IndexBox& box);
/// The empty crop of around(box).
[[nodiscard]] StructureCrop crop_around(const IndexBox& box);
/// Normals of the voxels of `runs` (principal axis z), in memory order. `crop` is a painted
/// crop_around() of a box that contains the runs.
[[nodiscard]] std::vector<PackedNormal> fit_normals(const StructureCrop& crop, std::span<const Run> runs,
                                                    const Grid& grid);
/// fit_normals() from the runs of the voxels around, with the same bits. Cost: about 0.2 us per voxel.
[[nodiscard]] std::vector<PackedNormal> fit_sparse_normals(const PartRows& rows, std::span<const Run> runs,
                                                           const Grid& grid);

/// The structure that determines the normals of a class: its first as boundary, or kNoStructure.
[[nodiscard]] StructureIndex normal_owner(std::span<const Membership> members);
/// [class]: normal_owner() of its memberships.
[[nodiscard]] std::vector<StructureIndex> normal_owners(const ClassTable& classes);

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

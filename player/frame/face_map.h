// Voxels around a cutting plane, for constant-time lookups of its face.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>

#include "format/atlas_reader.h"
#include "format/system/thread_pool.h"
#include "player/frame/face_classes.h"
#include "player/spans/class_cache.h"
#include "player/spans/sparse_bytes.h"
#include "player/transfer/volume_appearances.h"
#include "player/view/cut_rays.h"

namespace splatlas {

/// Voxels that faces can show. References must outlive the call.
struct FaceVoxels {
  const Atlas& atlas;
  const ClassCache& cache;                        ///< must hold the runs of `axis` of all classes with faces
  Axis axis = Axis::kZ;                           ///< of the runs; any axis gives the same map
  std::span<const FaceClass> classes;             ///< by ClassId; CutFaces::build() sets them
  std::span<const VolumeAppearance> appearances;  ///< of the plan's classes
};

/// Class and grey value at a point of a face.
struct FaceSample {
  ClassId id = kEmptyClass;  ///< of the nearest voxel; kEmptyClass: no face
  float grey = 0;  ///< interpolated between voxels with faces; 0 and 1 are the ends of the display window
};

/// The voxels within two layers of a plane, in columns along the axis nearest to its normal. Immutable and
/// thread-safe.
class FaceMap {
 public:
  /// kLimit if the system refuses address space. Cost: linear in the decoded runs and in the voxels near the
  /// plane. Only pages with such voxels are resident.
  [[nodiscard]] static Result<FaceMap> build(const VoxelPlane& plane, const FaceVoxels& voxels,
                                             ThreadPool& pool);

  /// Axes across the columns.
  [[nodiscard]] std::size_t axis_b() const { return b_; }
  [[nodiscard]] std::size_t axis_c() const { return c_; }
  /// The point of the plane with these continuous voxel indices along axis_b() and axis_c(). A point halfway
  /// between two voxel centres belongs to the voxel on the kept side.
  [[nodiscard]] FaceSample at(double b, double c) const;

 private:
  struct Texel {
    float grey = 0;
    ClassId id = kEmptyClass;
  };
  class Builder;

  [[nodiscard]] double height(double b, double c) const { return at_origin_ + per_b_ * b + per_c_ * c; }
  [[nodiscard]] std::size_t place(std::int64_t a, std::int64_t b, std::int64_t c) const {
    return static_cast<std::size_t>((((c - first_c_) * columns_ + (b - first_b_)) << layer_bits_) +
                                    (a & ((std::int64_t{1} << layer_bits_) - 1)));
  }
  [[nodiscard]] const Texel* texels() const { return reinterpret_cast<const Texel*>(texels_.data()); }

  std::size_t a_ = 2, b_ = 0, c_ = 1;             // columns run along a
  double at_origin_ = 0, per_b_ = 0, per_c_ = 0;  // position of the plane along a
  double reach_ = 0;                              // change of that position within a voxel along b and c
  double to_kept_ = 0;                            // tiny step along a into the kept part
  std::int64_t first_b_ = 0, first_c_ = 0;        // of the padded box of voxels with faces
  std::int64_t columns_ = 0, rows_ = 0;           // along b and c
  int layer_bits_ = 1;                            // layers of a column: 2^layer_bits, by position mod them
  SparseBytes texels_;
};

}  // namespace splatlas

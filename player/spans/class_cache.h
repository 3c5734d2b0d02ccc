// Decoded classes: what has been selected once stays decoded, so that a new selection reads only what is new.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "format/atlas_reader.h"
#include "format/system/thread_pool.h"
#include "player/missing_parts.h"
#include "player/spans/scanline_runs.h"
#include "player/spans/sparse_bytes.h"

namespace splatlas {

/// Of a plan: those that contribute to the volume, in its order.
[[nodiscard]] std::vector<ClassId> volume_classes(const DrawPlan& plan);

/// Reads classes from an atlas and keeps them. Values (and normals) of all decoded classes stand in one
/// volume in memory order of the grid, of which only the pages of decoded classes exist.
class ClassCache {
 public:
  explicit ClassCache(std::shared_ptr<const Atlas> atlas) : atlas_(std::move(atlas)) {}

  /// Makes runs of `axis` and values of every class in `classes` available, and normals if they are wanted;
  /// reads only what is missing. On failure nothing that has been read of the failed classes is kept; the
  /// others are there.
  [[nodiscard]] Result<void> require(std::span<const ClassId> classes, Axis axis, ThreadPool& pool,
                                     bool normals = true);
  /// The same for surfaces.
  [[nodiscard]] Result<void> require_surfaces(std::span<const StructureIndex> structures, ThreadPool& pool);
  /// What could not be read when it was required last.
  [[nodiscard]] std::span<const FailedClass> failed_classes() const { return failed_classes_; }
  [[nodiscard]] std::span<const FailedSurface> failed_surfaces() const { return failed_surfaces_; }

  /// The runs of all classes that have been required for an axis.
  [[nodiscard]] const ScanlineRuns& runs(Axis axis) const { return runs_[static_cast<std::size_t>(axis)]; }
  /// Only for classes, axes and structures that have been required.
  [[nodiscard]] std::size_t run_count(ClassId c, Axis axis) const;
  [[nodiscard]] const SurfaceMesh& surface(StructureIndex s) const;
  /// Values in memory order of the grid; null when the atlas has none. Only voxels of required classes are
  /// set.
  [[nodiscard]] const std::byte* values() const { return values_.data(); }
  [[nodiscard]] std::size_t value_bytes() const { return bytes_of(atlas_->value_type()); }
  /// Of all values, wherever they are set.
  [[nodiscard]] std::size_t bytes_of_values() const { return values_.size(); }
  /// Normals in memory order of the grid; null before any have been required. Only boundary voxels of classes
  /// whose normals have been required are set.
  [[nodiscard]] const PackedNormal* normals() const {
    return reinterpret_cast<const PackedNormal*>(normals_.data());
  }

 private:
  /// What is known of a class: its runs are kept with those of others.
  struct DecodedClass {
    std::array<std::optional<std::size_t>, 3> run_count;
    bool has_values = false, has_normals = false;
  };
  /// What a class lacks, and what has been read of that.
  struct Missing;
  [[nodiscard]] std::vector<Missing> missing_of(std::span<const ClassId> classes, Axis axis,
                                                bool normals) const;
  [[nodiscard]] Result<void> reserve(std::span<const Missing> missing);
  [[nodiscard]] Result<void> decode(Missing& missing, Axis axis) const;
  void keep_runs(std::span<const Missing> missing, Axis axis, ThreadPool& pool);

  std::shared_ptr<const Atlas> atlas_;
  std::unordered_map<ClassId, DecodedClass> classes_;
  std::array<ScanlineRuns, 3> runs_;
  std::unordered_map<StructureIndex, SurfaceMesh> surfaces_;
  std::vector<FailedClass> failed_classes_;
  std::vector<FailedSurface> failed_surfaces_;
  SparseBytes values_;
  SparseBytes normals_;
};

}  // namespace splatlas

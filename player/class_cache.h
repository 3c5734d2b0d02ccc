// Decoded classes: what has been selected once stays decoded, so that a new selection reads only what is new.
#pragma once

#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

#include "format/atlas_reader.h"
#include "player/thread_pool.h"

namespace splatlas {

/// One byte range per voxel of the grid, backed by memory only where it has been written.
class SparseBytes {
 public:
  SparseBytes() = default;
  SparseBytes(SparseBytes&& other) noexcept;
  SparseBytes& operator=(SparseBytes&& other) noexcept;
  ~SparseBytes();

  /// Reserves address space, no memory. kLimit when the system refuses.
  [[nodiscard]] static Result<SparseBytes> reserve(std::size_t bytes);
  [[nodiscard]] std::byte* data() const { return data_; }

 private:
  std::byte* data_ = nullptr;
  std::size_t size_ = 0;
};

/// Reads classes from an atlas and keeps them. Values (and normals) of all decoded classes stand in one
/// volume in memory order of the grid, of which only the pages of decoded classes exist.
class ClassCache {
 public:
  explicit ClassCache(std::shared_ptr<const Atlas> atlas) : atlas_(std::move(atlas)) {}

  /// Makes runs of `axis`, values and normals of every class in `classes` available; reads only what is
  /// missing. On failure nothing of the failed classes is kept.
  [[nodiscard]] Result<void> require(std::span<const ClassId> classes, Axis axis, ThreadPool& pool);
  /// The same for surfaces.
  [[nodiscard]] Result<void> require_surfaces(std::span<const StructureIndex> structures, ThreadPool& pool);

  /// Only for classes, axes and structures that have been required.
  [[nodiscard]] const ClassRuns& runs(ClassId c, Axis axis) const;
  [[nodiscard]] const SurfaceMesh& surface(StructureIndex s) const;
  /// Values in memory order of the grid; null when the atlas has none. Only voxels of required classes are
  /// set.
  [[nodiscard]] const std::byte* values() const { return values_.data(); }
  /// Normals in memory order of the grid. Only boundary voxels of required classes are set.
  [[nodiscard]] const PackedNormal* normals() const {
    return reinterpret_cast<const PackedNormal*>(normals_.data());
  }

 private:
  struct DecodedClass {
    ClassRuns runs[3];
    bool has_runs[3] = {false, false, false};
    bool has_voxels = false;  // values and normals
  };
  [[nodiscard]] Result<void> decode(ClassId c, Axis axis, DecodedClass& decoded);
  [[nodiscard]] Result<void> place_voxels(ClassId c, const ClassRuns& z_runs);

  std::shared_ptr<const Atlas> atlas_;
  std::unordered_map<ClassId, DecodedClass> classes_;
  std::unordered_map<StructureIndex, SurfaceMesh> surfaces_;
  SparseBytes values_;
  SparseBytes normals_;
};

}  // namespace splatlas

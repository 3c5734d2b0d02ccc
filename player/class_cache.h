// Decoded classes: what has been selected once stays decoded, so that a new selection reads only what is new.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "format/atlas_reader.h"
#include "player/scanline_runs.h"
#include "player/thread_pool.h"

namespace splatlas {

/// Of a plan: those that contribute to the volume, in its order.
[[nodiscard]] std::vector<ClassId> volume_classes(const DrawPlan& plan);

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
  [[nodiscard]] std::size_t size() const { return size_; }

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
  /// missing. On failure nothing that has been read of the failed classes is kept.
  [[nodiscard]] Result<void> require(std::span<const ClassId> classes, Axis axis, ThreadPool& pool);
  /// The same for surfaces.
  [[nodiscard]] Result<void> require_surfaces(std::span<const StructureIndex> structures, ThreadPool& pool);

  /// The runs of all classes that have been required for an axis; some are there that have not been.
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
  /// Normals in memory order of the grid. Only boundary voxels of required classes are set.
  [[nodiscard]] const PackedNormal* normals() const {
    return reinterpret_cast<const PackedNormal*>(normals_.data());
  }

 private:
  /// What is known of a class: its runs are kept with those of others.
  struct DecodedClass {
    std::array<std::optional<std::size_t>, 3> run_count;
    bool has_voxels = false;  // values and normals
  };
  /// Runs that have been read and are not kept yet.
  using NewRuns = std::array<std::optional<ClassRuns>, 3>;
  [[nodiscard]] Result<void> decode(ClassId c, Axis axis, DecodedClass& decoded, NewRuns& read);
  void keep_runs(Axis axis, std::span<const std::pair<ClassId, const ClassRuns*>> runs, ThreadPool& pool);
  [[nodiscard]] Result<void> place_voxels(ClassId c, const ClassRuns& z_runs);

  std::shared_ptr<const Atlas> atlas_;
  std::unordered_map<ClassId, DecodedClass> classes_;
  std::array<ScanlineRuns, 3> runs_;
  std::unordered_map<StructureIndex, SurfaceMesh> surfaces_;
  SparseBytes values_;
  SparseBytes normals_;
};

}  // namespace splatlas

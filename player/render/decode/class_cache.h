// Cache of decoded classes, and their runs, merged by scanline.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "format/atlas_reader.h"
#include "format/content/decision_tree.h"
#include "format/content/run_model.h"
#include "format/derive/coarse_surface.h"
#include "format/tasks/thread_pool.h"
#include "player/picture.h"
#include "player/render/decode/lit_voxels.h"
#include "player/render/decode/sparse_bytes.h"
#include "player/render/decode/surface_clusters.h"

namespace splatlas {

class TransferTable;

/// A run of a class within a slice.
struct ClassRun {
  std::uint32_t row = 0, start = 0, length = 0;
  ClassId id = kEmptyClass;
};

/// The runs of all inserted classes for one principal axis, by slice, row and start. A change of selection
/// needs no sorting: traversal filters the runs in order. Slices without runs take neither memory nor time.
class ScanlineRuns {
 public:
  /// Adds new classes, each with its runs in traversal order. `rows` is the number of rows of a slice of the
  /// grid, the same in every call. Cost: linear in the new runs and in the existing runs of their slices,
  /// which are merged in parallel. Not thread-safe. Throws std::bad_alloc.
  void insert(std::span<const std::pair<ClassId, const ClassRuns*>> classes, std::int64_t rows,
              ThreadPool& pool);

  /// The runs of a slice of the grid; empty for slices without insertions. Cost: logarithmic in the slices.
  [[nodiscard]] std::span<const ClassRun> slice(std::int64_t n) const;
  /// Numbers of the slices with runs from `first` to `last`, inclusive, ascending.
  [[nodiscard]] std::span<const std::int64_t> occupied(std::int64_t first, std::int64_t last) const;

 private:
  void make_room(std::span<const std::int64_t> numbers);

  std::vector<std::int64_t> numbers_;          // of slices with runs, ascending
  std::vector<std::vector<ClassRun>> slices_;  // [index into numbers_]
};

/// Class with unreadable voxels.
struct FailedClass {
  ClassId id = kEmptyClass;
  Error error;
};
/// Structure with an unreadable surface.
struct FailedSurface {
  StructureIndex structure = kNoStructure;
  Error error;
};

/// Removes unreadable classes and surfaces from a plan, and returns them by structure. All classes of the
/// same structures are removed with a class, so interior and boundary are drawn together or not at all.
/// Voxels count for the structure that gives them their appearance. O(classes + surfaces).
[[nodiscard]] std::vector<MissingPart> leave_out(std::span<const FailedClass> failed_classes,
                                                 std::span<const FailedSurface> failed_surfaces,
                                                 const ClassTable& classes, DrawPlan& plan);

/// Classes of a plan that contribute to the volume, in the plan's order.
[[nodiscard]] std::vector<ClassId> volume_classes(const DrawPlan& plan);

/// Decoded parts of a class. Each value includes those before it.
enum class VoxelParts : std::uint8_t { kNone, kRuns, kValues, kNormals };

/// State of the light of a class.
struct LightState {
  enum class Of : std::uint8_t { kLabel, kNothing, kBorder, kInterior } of = Of::kLabel;
  StructureIndex structure = kNoStructure;  ///< of borders and interiors: that they are drawn as
  /// Of interiors; their address tells them apart within a generation of VolumeAppearances.
  const TransferTable* transfer = nullptr;
  std::uint64_t generation = 0;

  friend bool operator==(const LightState&, const LightState&) = default;
};

/// Cache of an atlas's classes and surfaces: a new selection reads only its new parts. Values (and light)
/// of all decoded classes share one volume in memory order of the grid. Only written pages are resident.
/// Caches of one atlas share surfaces. A cache is not thread-safe, except for const members.
class ClassCache {
 public:
  struct DecodedSurface {
    SurfaceMesh mesh;
    SurfaceClusters clusters;
  };

  explicit ClassCache(std::shared_ptr<const Atlas> atlas) : atlas_(std::move(atlas)) {}

  /// Makes parts of `classes` available, with runs of `axis`; reads only missing parts, in parallel. Normals
  /// come as light, and with runs of z if they may be refined by grey values (light_voxels()). Classes that
  /// fail are listed in failed_classes() and not kept; others become available. Returns the first failure.
  [[nodiscard]] Result<void> require(std::span<const ClassId> classes, Axis axis, ThreadPool& pool,
                                     VoxelParts parts = VoxelParts::kNormals);
  /// Keeps voxels of another grid, as if they had been decoded: runs along an axis of classes that have none
  /// there. `rows`: of a slice of that grid.
  void keep_runs(std::span<const std::pair<ClassId, const ClassRuns*>> runs, Axis axis, std::int64_t rows,
                 ThreadPool& pool);
  /// Their values and light, in memory order of that grid.
  void keep_voxels(SparseBytes values, SparseBytes lights) {
    values_ = std::move(values);
    lights_ = std::move(lights);
  }
  [[nodiscard]] bool has_values(ClassId c) const {
    const auto known = classes_.find(c);
    return known != classes_.end() && known->second.has_values;
  }
  /// The same for surfaces of a level of detail (Atlas::read_surface()).
  [[nodiscard]] Result<void> require_surfaces(std::span<const StructureIndex> structures, ThreadPool& pool,
                                              int level = 0);
  [[nodiscard]] bool has_surface(StructureIndex s, int level) const {
    return surfaces_.contains({kept_level(s, level), s});
  }
  /// Failures of the latest require() and require_surfaces().
  [[nodiscard]] std::span<const FailedClass> failed_classes() const { return failed_classes_; }
  [[nodiscard]] std::span<const FailedSurface> failed_surfaces() const { return failed_surfaces_; }

  /// Approximate bytes of everything decoded.
  [[nodiscard]] std::uint64_t bytes() const;
  /// Begins a selection. Of surfaces other than `drawn` (ascending), keeps the latest used `bytes` at most.
  void begin(std::span<const StructureIndex> drawn, std::uint64_t bytes);

  /// The runs of all classes that have been required for an axis.
  [[nodiscard]] const ScanlineRuns& runs(Axis axis) const { return runs_[static_cast<std::size_t>(axis)]; }
  /// Number of runs, and a surface; the class, axis or structure must have been required.
  [[nodiscard]] std::size_t run_count(ClassId c, Axis axis) const {
    return *classes_.at(c).run_count[static_cast<std::size_t>(axis)];
  }
  [[nodiscard]] const DecodedSurface& surface(StructureIndex s, int level = 0) const {
    return *surfaces_.at({kept_level(s, level), s}).decoded;
  }
  /// Values in memory order of the grid, defined at voxels of required classes; null for an atlas without.
  [[nodiscard]] const std::byte* values() const { return values_.data(); }
  [[nodiscard]] VoxelType value_type() const { return atlas_->value_type(); }
  [[nodiscard]] std::size_t value_bytes() const { return bytes_of(atlas_->value_type()); }
  [[nodiscard]] std::size_t bytes_of_values() const { return values_.size(); }
  /// Light in memory order of the grid; null before any normals have been required. First that of the normals
  /// of boundary voxels; see light_voxels().
  [[nodiscard]] const VoxelLight* lights() const {
    return reinterpret_cast<const VoxelLight*>(lights_.data());
  }
  /// The light of a voxel and then of the next ones; null if none: without greys, only borders have light.
  [[nodiscard]] const VoxelLight* light(std::size_t voxel, bool boundary) const {
    return boundary || values() != nullptr ? lights() + voxel : nullptr;
  }
  [[nodiscard]] std::size_t bytes_of_lights() const { return lights_.size(); }
  [[nodiscard]] VoxelLight* lights() { return reinterpret_cast<VoxelLight*>(lights_.data()); }
  [[nodiscard]] LightState& light_state(ClassId c) { return classes_.at(c).light; }
  /// Before a class is drawn as border of a structure: its normals are missing if other light replaced them.
  void forget_lost_normals(ClassId c, StructureIndex structure);

 private:
  /// Decoded parts of a class. ScanlineRuns keeps the runs of all classes.
  struct DecodedClass {
    std::array<std::optional<std::size_t>, 3> run_count;
    bool has_values = false, has_normals = false;
    LightState light;
  };
  using SharedSurface = std::shared_ptr<const DecodedSurface>;
  using SurfaceKey = std::pair<std::size_t, StructureIndex>;  // level as kept, structure
  struct KeptSurface {
    SharedSurface decoded;
    std::uint64_t used = 0;  // number of the latest selection that draws it
    /// Of mesh and clusters, with half a vertex a triangle.
    [[nodiscard]] std::uint64_t bytes() const { return 76 * decoded->mesh.triangles.size(); }
  };
  /// Decodes a surface, unless another cache of this atlas has it: both then share it.
  [[nodiscard]] Result<SharedSurface> decode_surface(StructureIndex s, int level) const;
  /// The level as which a surface is kept.
  [[nodiscard]] std::size_t kept_level(StructureIndex s, int level) const {
    return level > 0 && atlas_->has_levels(s) ? static_cast<std::size_t>(level) : 0;
  }
  struct Missing;
  [[nodiscard]] std::vector<Missing> missing_of(std::span<const ClassId> classes, Axis axis,
                                                VoxelParts parts) const;
  /// Upper bound of the bytes that these classes will take.
  [[nodiscard]] double memory_of(std::span<const Missing> missing, Axis axis, VoxelParts parts) const;
  [[nodiscard]] Result<void> reserve(std::span<const Missing> missing);
  [[nodiscard]] Result<void> decode(Missing& missing) const;
  std::shared_ptr<const Atlas> atlas_;
  std::unordered_map<ClassId, DecodedClass> classes_;
  std::array<ScanlineRuns, 3> runs_;
  std::map<SurfaceKey, KeptSurface> surfaces_;
  std::uint64_t selection_ = 0;  // number of the current one
  std::vector<FailedClass> failed_classes_;
  std::vector<FailedSurface> failed_surfaces_;
  SparseBytes values_;
  SparseBytes lights_;
};

}  // namespace splatlas

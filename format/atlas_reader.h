// Random-access reader of atlas files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "format/content/atlas_content.h"
#include "format/content/decision_tree.h"
#include "format/content/run_model.h"
#include "format/result.h"
#include "format/tasks/work_budget.h"

namespace splatlas {

class InputFile;

/// Size of one part of the file.
struct SectionSize {
  std::string name;  ///< "header", "directory", "runs_x", "runs_y", "runs_z", "values", "normals",
                     ///< "surfaces", "means"
  std::uint64_t bytes = 0;
};

/// Rule of the surfaces that a reader derives from the voxels. Stored surfaces do not change.
enum class SurfaceChoice : std::uint8_t {
  kAsInFile,
  kSmooth,  ///< what smooths in the grid, if it admits that: rule_for()
  kVoxels   ///< vertices midway between voxels
};

/// Options of Atlas::open().
struct AtlasOptions {
  /// Factor of the limit of work (WorkBudget): above 1 for very large files, below 1 for untrusted ones.
  double max_work = 1;
  std::uint64_t memory_bytes = 0;  ///< memory that the process may use; 0: the machine's
  SurfaceChoice surfaces = SurfaceChoice::kAsInFile;
};

/// An open atlas. open() reads and checks only the header and the directory. The read functions load chunks
/// on demand and verify their checksums. Every size, offset and index is checked before use: untrusted files
/// are safe, and so are files that are truncated, replaced or overwritten while open. Thread-safe.
///
/// Errors of all functions: kFailed if the file cannot be read, kInvalidAtlas if it is damaged, kUsage for a
/// class or structure out of range, kLimit if memory or the work budget does not suffice.
class Atlas {
 public:
  /// Opens a file. kInvalidAtlas also if it is not an atlas or its version is too new.
  [[nodiscard]] static Result<std::shared_ptr<const Atlas>> open(const std::filesystem::path& path,
                                                                 const AtlasOptions& options = {});
  /// Opens an atlas in memory. Messages call it `name`.
  [[nodiscard]] static Result<std::shared_ptr<const Atlas>> open_bytes(std::vector<std::byte> bytes,
                                                                       std::string name = "(memory)",
                                                                       const AtlasOptions& options = {});
  /// The same of any input (format/io/input_file.h), such as a file on a server.
  [[nodiscard]] static Result<std::shared_ptr<const Atlas>> open_file(InputFile file,
                                                                      const AtlasOptions& options = {});
  ~Atlas();
  Atlas(const Atlas&) = delete;
  Atlas& operator=(const Atlas&) = delete;

  [[nodiscard]] const std::string& name() const;     ///< the path, for messages
  [[nodiscard]] std::string format_version() const;  ///< "1.0"
  [[nodiscard]] const Grid& grid() const;            ///< storage grid
  [[nodiscard]] const Grid& source_grid() const;     ///< of the source file, unchanged
  [[nodiscard]] const AxisOrder& source_to_storage() const;
  [[nodiscard]] const StructureGraph& graph() const;
  [[nodiscard]] const ClassTable& classes() const;
  [[nodiscard]] const DecisionTree& tree() const;
  [[nodiscard]] const Display& display() const;
  [[nodiscard]] const std::vector<Scene>& scenes() const;
  [[nodiscard]] const Provenance& provenance() const;
  [[nodiscard]] VoxelType value_type() const;  ///< kNone if the atlas has no grey values
  [[nodiscard]] VoxelType label_type() const;  ///< of the source label map
  [[nodiscard]] std::uint64_t triangles(StructureIndex s) const;
  [[nodiscard]] std::uint64_t runs(Axis axis) const;  ///< number of runs in that run model
  [[nodiscard]] double reference_length_mm() const;   ///< cube root of the volume of a voxel

  /// Reads and validates the runs of one class; none for the empty class. If a compact file does not store
  /// the axis, derives them from the z model.
  [[nodiscard]] Result<ClassRuns> read_runs(ClassId c, Axis axis) const;
  /// [structure]: colours that keep structures which touch apart, also for colour-blind eyes
  /// (format/derive/distinct_colors.h). Groups keep theirs. kInvalidAtlas if a run is damaged. Cost: reads
  /// all runs of the z model; O(runs * log(classes)).
  [[nodiscard]] Result<std::vector<Rgb>> distinct_colors() const;
  /// Grey values of the voxels of a class (including the empty class) in memory order:
  /// voxels(c) * bytes_of(value_type()) bytes.
  [[nodiscard]] Result<std::vector<std::byte>> read_values(ClassId c) const;
  /// The means of the grey values of a class, and of all classes in the same structures, in blocks of voxels
  /// (format/content/run_model.h): stored ones, else those of the values.
  /// Without values in the atlas, only blocks and voxels.
  [[nodiscard]] Result<BlockMeans> read_means(ClassId c) const;
  /// True if these means are stored, so that they are read without the values. `c` must be a class.
  [[nodiscard]] bool has_means(ClassId c) const;
  /// Normals of a class with a boundary membership, in memory order; empty for other classes.
  [[nodiscard]] Result<std::vector<PackedNormal>> read_normals(ClassId c) const;
  /// Frees the runs that it keeps for other parts of their classes, if they take more than 8 MiB.
  void forget_runs() const;
  /// The surface of one structure; empty for a group. `level`: for drafts, that of blocks of 2^level voxels
  /// along each axis (format/derive/coarse_surface.h), or the coarsest that keeps the structure's parts.
  [[nodiscard]] Result<SurfaceMesh> read_surface(StructureIndex s, int level = 0) const;
  /// True if its surface has coarser levels: it follows from voxels that are not scattered over their box.
  [[nodiscard]] bool has_levels(StructureIndex s) const;

  /// Decodes the whole content for export and rewriting: exactly as written with SurfaceChoice::kAsInFile.
  [[nodiscard]] Result<AtlasContent> read_all() const;
  /// The content without values, surfaces and normals; succeeds even if these are damaged.
  [[nodiscard]] Result<AtlasContent> read_classes() const;
  /// The grey values of all voxels. `class_volume` is the one of read_classes().
  [[nodiscard]] Result<VoxelBuffer> read_value_volume(std::span<const ClassId> class_volume) const;
  /// Passes the bytes of this file with other scenes to `write`, piece by piece: header, directory, and every
  /// chunk as it is stored, those of unknown sections too. Checks the checksums of the chunks, but decodes
  /// none. kFailed for scenes that a file cannot hold, and for a directory with fields of a newer minor
  /// version; errors of `write`. Linear in the file; memory: the directory and one chunk.
  [[nodiscard]] Result<void> copy_with_scenes(
      std::vector<Scene> scenes, const std::function<Result<void>(std::span<const std::byte>)>& write) const;
  /// Reads and checks every byte of the file. Returns the first fault, with its section, or success.
  [[nodiscard]] Result<void> verify() const;

  /// Limit of the functions above. Each counts its own work, unless the thread's task counts it.
  [[nodiscard]] const WorkBudget& work_budget() const;

  [[nodiscard]] std::vector<SectionSize> sections() const;
  /// Bytes of the file, bytes read (header, directory and each chunk once) and bytes decoded.
  struct Counters {
    std::uint64_t file = 0, read = 0, decoded = 0;
  };
  [[nodiscard]] Counters counters() const;

 private:
  struct Impl;
  explicit Atlas(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace splatlas

// Opens an atlas file and reads the parts that are asked for.
#pragma once

#include <atomic>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "format/atlas_content.h"
#include "format/decision_tree.h"
#include "format/result.h"
#include "format/run_model.h"

namespace splatlas {

class InputFile;

struct SectionSize {
  std::string name;  ///< "header", "directory", "runs_x", "runs_y", "runs_z", "values", "normals", "surfaces"
  std::uint64_t bytes = 0;
};

/// An open atlas. open() reads and checks the header and the directory and nothing else; every other byte is
/// read, and its checksum checked, when it is first asked for. Every size, offset and index is checked before
/// use: safe to open from strangers, and safe when the file is truncated, replaced or overwritten meanwhile.
/// All members are const and safe to call from several threads.
class Atlas {
 public:
  /// kFailed when the file cannot be read, kInvalidAtlas when it is not an atlas, damaged, or too new.
  [[nodiscard]] static Result<std::shared_ptr<const Atlas>> open(const std::filesystem::path& path);
  /// The same from bytes in memory. `name` stands for the file in messages.
  [[nodiscard]] static Result<std::shared_ptr<const Atlas>> open_bytes(std::vector<std::byte> bytes,
                                                                       std::string name = "(memory)");
  ~Atlas();
  Atlas(const Atlas&) = delete;
  Atlas& operator=(const Atlas&) = delete;

  [[nodiscard]] const std::string& name() const;     ///< the path, for messages
  [[nodiscard]] std::string format_version() const;  ///< "1.0"
  [[nodiscard]] const Grid& grid() const;            ///< storage grid
  [[nodiscard]] const Grid& source_grid() const;     ///< as the source file had it, exactly
  [[nodiscard]] const AxisOrder& source_to_storage() const;
  [[nodiscard]] const StructureGraph& graph() const;
  [[nodiscard]] const ClassTable& classes() const;
  [[nodiscard]] const DecisionTree& tree() const;
  [[nodiscard]] const Display& display() const;
  [[nodiscard]] const std::vector<Scene>& scenes() const;
  [[nodiscard]] const Provenance& provenance() const;
  [[nodiscard]] VoxelType value_type() const;  ///< kNone: the atlas has no grey values
  [[nodiscard]] VoxelType label_type() const;  ///< of the source label map
  [[nodiscard]] std::uint64_t triangles(StructureIndex s) const;
  [[nodiscard]] std::uint64_t runs(Axis axis) const;  ///< all runs of that run model
  [[nodiscard]] double reference_length_mm() const;   ///< cube root of a voxel's volume

  /// Runs of one class, checked. Derived from the z model where a compact file leaves out the axis. None for
  /// the empty class: it is what remains.
  [[nodiscard]] Result<ClassRuns> read_runs(ClassId c, Axis axis) const;
  /// Grey values of a class's voxels (the empty class too), in memory order: voxels(c) *
  /// bytes_of(value_type()).
  [[nodiscard]] Result<std::vector<std::byte>> read_values(ClassId c) const;
  /// Normals of a class with a boundary membership, in memory order; empty for other classes.
  [[nodiscard]] Result<std::vector<PackedNormal>> read_normals(ClassId c) const;
  /// The surface of one structure; empty for a group.
  [[nodiscard]] Result<SurfaceMesh> read_surface(StructureIndex s) const;

  /// Everything, decoded, for export and rewriting: the content as it was written.
  [[nodiscard]] Result<AtlasContent> read_all() const;
  /// The content without values, surfaces and normals, for which damage to these does no harm.
  [[nodiscard]] Result<AtlasContent> read_classes() const;
  /// The grey values of all voxels, given the class volume that read_classes() gave.
  [[nodiscard]] Result<VoxelBuffer> read_value_volume(std::span<const ClassId> class_volume) const;
  /// Reads and checks every byte of the file. The first fault found, told with its section, or success.
  [[nodiscard]] Result<void> verify() const;

  [[nodiscard]] std::vector<SectionSize> sections() const;
  /// Bytes: of the file; of it touched so far (header, directory and chunks, each once); decoded from chunks.
  struct Counters {
    std::uint64_t file = 0, read = 0, decoded = 0;
  };
  [[nodiscard]] Counters counters() const;

 private:
  struct Impl;
  [[nodiscard]] static Result<std::shared_ptr<const Atlas>> open_file(InputFile file);
  explicit Atlas(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace splatlas

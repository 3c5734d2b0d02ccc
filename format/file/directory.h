// The directory of an atlas file, as plain structs. FlatBuffers stays inside directory.cpp.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "format/atlas_content.h"
#include "format/class_table.h"
#include "format/codec/chunk_codec.h"
#include "format/codec/surface_codec.h"
#include "format/grid.h"
#include "format/result.h"
#include "format/structure_graph.h"
#include "format/voxel_type.h"

namespace splatlas {

class RunStreams;

/// Classes of one file.
inline constexpr std::size_t kMaxClasses = std::size_t{1} << 24;

/// Stored in files: values must not change. Other values are sections of newer versions.
enum class SectionKind : std::uint32_t {
  kRunsX = 1,
  kRunsY = 2,
  kRunsZ = 3,
  kValues = 4,
  kNormals = 5,
  kSurfaces = 6,
};
/// "runs_x", ..., "surfaces"; "section 17" for a kind of a newer version.
[[nodiscard]] std::string section_name(std::uint32_t kind);
[[nodiscard]] constexpr SectionKind run_section(Axis axis) {
  return static_cast<SectionKind>(static_cast<std::uint32_t>(SectionKind::kRunsX) +
                                  static_cast<std::uint32_t>(axis));
}

struct SectionEntry {
  std::uint32_t kind = 0;
  std::uint32_t chunks = 0;
  std::uint32_t chunk_bytes = 0, shared_bytes = 0;  ///< see cut_streams()
};

struct Directory {
  Grid source_grid;
  AxisOrder source_to_storage;
  VoxelType value_type = VoxelType::kNone;
  VoxelType label_type = VoxelType::kNone;
  Display display;
  StructureGraph graph;
  ClassTable classes;
  std::vector<std::array<std::uint32_t, 3>> run_bytes;  ///< [class][axis], decoded; 0 where not stored
  std::array<std::uint64_t, 3> run_totals{};            ///< [axis], stored or not
  std::vector<bool> normals_fitted;                     ///< [class]: not stored, fit_normals() finds them
  std::vector<SurfaceEntry> surfaces;                   ///< per structure
  std::vector<Scene> scenes;
  Provenance provenance;
  std::vector<SectionEntry> sections;  ///< in file order
  std::vector<ChunkEntry> chunks;      ///< of all sections, in file order
};

/// Whether the class has a boundary membership: its voxels carry normals.
[[nodiscard]] bool has_normals(const ClassTable& classes, ClassId c);
/// Whether the file has them.
[[nodiscard]] bool stores_normals(const Directory& directory, ClassId c);

/// The directory's bytes. Same directory: same bytes.
[[nodiscard]] Result<std::vector<std::byte>> encode_directory(const Directory& directory);

/// Reads a directory from a stranger: `bytes` must be aligned to 8 and must not change meanwhile. Structures
/// and classes are checked as they are built; what the fields mean is checked by validate(). kInvalidAtlas.
[[nodiscard]] Result<Directory> decode_directory(std::span<const std::byte> bytes);

/// Checks everything that a directory says about itself: the grid, types, finite numbers, text, class boxes
/// and voxel counts, stream lengths against what the geometry allows. kInvalidAtlas, naming the class or
/// structure.
[[nodiscard]] Result<void> validate(const Directory& directory);
/// The same, with what readers have made of the classes already.
[[nodiscard]] Result<void> validate(const Directory& directory, const RunStreams& streams);

}  // namespace splatlas

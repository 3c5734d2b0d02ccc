// Directory of an atlas file, and its FlatBuffers encoding.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "format/codec/chunk_codec.h"
#include "format/codec/surface_codec.h"
#include "format/content/atlas_content.h"
#include "format/content/class_table.h"
#include "format/content/grid.h"
#include "format/content/structure_graph.h"
#include "format/content/voxel_type.h"
#include "format/derive/run_fingerprint.h"
#include "format/result.h"

namespace splatlas {

class RunStreams;

/// Maximum number of classes of one file.
inline constexpr std::size_t kMaxClasses = std::size_t{1} << 24;

/// Numbers are part of the file format and must not change. Other numbers are sections of newer versions.
enum class SectionKind : std::uint32_t {
  kRunsX = 1,
  kRunsY = 2,
  kRunsZ = 3,
  kValues = 4,
  kNormals = 5,
  kSurfaces = 6,
  kMeans = 7,
};
/// "runs_x", ..., "means"; "section 17" for an unknown kind.
[[nodiscard]] std::string section_name(std::uint32_t kind);
[[nodiscard]] inline std::string section_name(SectionKind kind) {
  return section_name(static_cast<std::uint32_t>(kind));
}
/// The section of the run model of an axis.
[[nodiscard]] constexpr SectionKind run_section(Axis axis) {
  return static_cast<SectionKind>(static_cast<std::uint32_t>(SectionKind::kRunsX) +
                                  static_cast<std::uint32_t>(axis));
}

/// Directory entry of a section.
struct SectionEntry {
  std::uint32_t kind = 0;
  std::uint32_t chunks = 0;
  std::uint32_t chunk_bytes = 0, shared_bytes = 0;  ///< see cut_streams()
};

/// Decoded directory.
struct Directory {
  Grid source_grid;
  AxisOrder source_to_storage;
  VoxelType value_type = VoxelType::kNone;
  VoxelType label_type = VoxelType::kNone;
  Display display;
  StructureGraph graph;
  ClassTable classes;
  std::vector<std::array<std::uint32_t, 3>> run_bytes;  ///< [class][axis], decoded length; 0 if not stored
  std::array<std::uint64_t, 3> run_totals{};            ///< [axis], stored or not
  std::vector<VoxelSetFingerprint> fingerprints;        ///< [class]: of its voxels
  std::vector<bool> normals_fitted;                     ///< [class]: not stored, derived by fit_normals()
  std::vector<SurfaceEntry> surfaces;                   ///< per structure
  std::vector<std::uint32_t> mean_blocks;               ///< [group]: blocks with a stored mean; empty: none
  std::vector<Scene> scenes;
  Provenance provenance;
  std::vector<SectionEntry> sections;  ///< in file order
  std::vector<ChunkEntry> chunks;      ///< of all sections, in file order
  bool has_newer_fields = false;       ///< of a newer minor version; decoding leaves them out
};

/// True if the voxels of a class have normals: it has a boundary membership.
[[nodiscard]] bool has_normals(const ClassTable& classes, ClassId c);
/// True if the file stores the normals of a class.
[[nodiscard]] bool stores_normals(const Directory& directory, ClassId c);

/// Encodes a directory. Deterministic. kFailed beyond kMaxDirectoryBytes.
[[nodiscard]] Result<std::vector<std::byte>> encode_directory(const Directory& directory);

/// Decodes an untrusted directory and checks its tables, structures and classes: kInvalidAtlas. validate()
/// checks the rest. `bytes` must be aligned to 8.
[[nodiscard]] Result<Directory> decode_directory(std::span<const std::byte> bytes);

/// Checks the grid, types, finite numbers, text, class boxes, voxel counts and stream lengths of a directory.
/// kInvalidAtlas with the class or structure in the message.
[[nodiscard]] Result<void> validate(const Directory& directory);
/// The same with precomputed streams of its classes.
[[nodiscard]] Result<void> validate(const Directory& directory, const RunStreams& streams);

}  // namespace splatlas

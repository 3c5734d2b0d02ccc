// Import of all source files of a build.
#pragma once

#include <string>
#include <vector>

#include "format/atlas_content.h"
#include "preprocess/classify/segment_volume.h"
#include "preprocess/membership_volume.h"
#include "preprocess/structures/build_graph.h"
#include "preprocess/surfaces/clip_mesh.h"

namespace splatlas {

/// Source files from the command line. Empty paths are not given.
struct SourceFiles {
  std::filesystem::path labels;  ///< a label map, or a folder of masks
  std::filesystem::path volume, names, colors, tree;
  std::vector<SegmentRule> segments;
  struct Mesh {
    std::string name;
    std::filesystem::path file;
  };
  std::vector<Mesh> meshes;
  MeshFrame mesh_frame = MeshFrame::kLps;
  bool allow_empty = false;
};

/// Imported sources. Volumes are in the storage order of `source_grid`. Source numbers of structures: labels
/// or masks first, then segments, then meshes.
struct SourceModel {
  Grid source_grid;
  VoxelBuffer values;  ///< empty() without a volume
  VoxelType label_type = VoxelType::kNone;
  MembershipVolume memberships{Index3{0, 0, 0}};  ///< of labels or masks; build_content() adds segments
  std::vector<SourceStructure> structures;

  struct Segment {
    SegmentRule rule;
    std::vector<std::uint8_t> mask;  ///< from the file of a mask rule; else empty
  };
  std::vector<Segment> segments;
  std::vector<ClippedMesh> meshes;

  std::vector<TreeLine> tree;
  std::string tree_file;
  std::vector<Source> provenance;
  std::vector<std::string> notes;  ///< notes and warnings, one line each
};

/// Reads and checks the files; errors are those of the importers. All volumes must have the same grid, and
/// names of structures must be unique (ignoring case). `progress` receives the fraction done and may be
/// empty.
[[nodiscard]] Result<SourceModel> import_sources(const SourceFiles& files,
                                                 const std::function<void(double)>& progress = {});

/// All files that import_sources() would read, including those in folders.
[[nodiscard]] std::vector<std::filesystem::path> list_files(const SourceFiles& files);

}  // namespace splatlas

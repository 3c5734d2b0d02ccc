// Reads everything that a build starts from.
#pragma once

#include <string>
#include <vector>

#include "format/atlas_content.h"
#include "preprocess/classify/segment_volume.h"
#include "preprocess/membership_volume.h"
#include "preprocess/structures/build_graph.h"
#include "preprocess/surfaces/clip_mesh.h"

namespace splatlas {

/// What the author names on the command line. Empty paths: not given.
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

/// Everything that the files hold, in memory. Volumes are in the storage order of `source_grid`. Structures
/// have source numbers: those of labels or masks first, then the segments, then the meshes.
struct SourceModel {
  Grid source_grid;
  VoxelBuffer values;  ///< empty() without a volume
  VoxelType label_type = VoxelType::kNone;
  MembershipVolume memberships{Index3{0, 0, 0}};  ///< of labels or masks; segments come later
  std::vector<SourceStructure> structures;

  struct Segment {
    SegmentRule rule;
    std::vector<std::uint8_t> mask;  ///< what a mask rule's file holds; else empty
  };
  std::vector<Segment> segments;
  std::vector<ClippedMesh> meshes;

  std::vector<TreeLine> tree;
  std::string tree_file;
  std::vector<Source> provenance;
  std::vector<std::string> notes;  ///< oddities that are no errors, one line each
};

/// Reads and checks the files, each with an error of one line (see the importers). All volumes must be on one
/// grid, and no two structures share a name (case aside). `progress` gets the fraction done and may be empty.
[[nodiscard]] Result<SourceModel> import_sources(const SourceFiles& files,
                                                 const std::function<void(double)>& progress = {});

/// Every file that import_sources would read, folders listed.
[[nodiscard]] std::vector<std::filesystem::path> list_files(const SourceFiles& files);

}  // namespace splatlas

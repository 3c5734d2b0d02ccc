// Decoded content of an atlas in memory: output of preprocess, input of the writer.
#pragma once

#include <string>
#include <vector>

#include "format/content/class_table.h"
#include "format/content/grid.h"
#include "format/content/structure_graph.h"
#include "format/content/surface.h"
#include "format/content/unit_vector.h"
#include "format/content/voxel_type.h"

namespace splatlas {

/// A named view of a selection: one step of a lesson.
struct Scene {
  std::string name;
  std::string caption;    ///< may have several lines
  std::string selection;  ///< selection text (docs/selections.md)
  double azimuth_deg = 0, elevation_deg = 0, zoom = 1;
  std::string question = {};  ///< asked before the caption is shown; may be empty
  std::string cuts = {};      ///< of parse_cuts()
  std::string center = {};    ///< of parse_center(); empty: the middle of the selection
  bool perspective = false;   ///< projection of the picture; else parallel
  /// Names (find_named()) without line feeds, labelled; a group as a whole. Empty: the largest structures.
  std::vector<std::string> labels = {};
  friend bool operator==(const Scene&, const Scene&) = default;
};

/// One input file. A whitelist: no other metadata of a source is copied, so that no patient data leaks.
struct Source {
  std::string role;  ///< "volume", "labels", "names", "tree", "mesh"
  std::string hash;  ///< "sha256:<64 hex digits>" of the file's bytes
  friend bool operator==(const Source&, const Source&) = default;
};
/// Origin of the data.
struct Provenance {
  std::string title, citation, licence;  ///< as given by the author
  std::string tool;                      ///< "splatlas-preprocess 0.1.0"
  std::vector<Source> sources;
  friend bool operator==(const Provenance&, const Provenance&) = default;
};

/// Default display window of grey values, and the bounding sphere that a camera frames.
struct Display {
  double window_low = 0, window_high = 1;  ///< grey values
  Vec3 center_lps_mm{0, 0, 0};             ///< centre of the bounding sphere of all structures' voxels
  double radius_mm = 1;                    ///< of that sphere; voxel corners included
  friend bool operator==(const Display&, const Display&) = default;
};

/// All data of an atlas. Volumes are in the storage grid (see storage_order), i fastest.
struct AtlasContent {
  Grid source_grid;             ///< of the input files, unchanged
  AxisOrder source_to_storage;  ///< storage grid = reordered(source_grid, source_to_storage)
  StructureGraph graph;
  ClassTable classes;                       ///< in storage_order(classes, graph)
  std::vector<ClassId> class_volume;        ///< class of every voxel
  VoxelBuffer values;                       ///< grey value of every voxel; empty() without a volume
  VoxelType label_type = VoxelType::kNone;  ///< of the source label map; kNone without one
  std::vector<SurfaceMesh> surfaces;        ///< per structure; empty meshes for groups
  /// Per structure, or empty: with triangles where `surfaces` leaves out the surface, and the normals of the
  /// classes that the structure owns are the derived ones too. The writer does not check either.
  std::vector<FittedSurface> fitted = {};
  /// [class][n-th voxel of the class in memory order]; empty for classes without a boundary membership.
  std::vector<std::vector<PackedNormal>> boundary_normals;
  Display display;
  std::vector<Scene> scenes;
  Provenance provenance;
};

/// Storage grid of the content.
[[nodiscard]] inline Grid storage_grid(const AtlasContent& content) {
  return reordered(content.source_grid, content.source_to_storage);
}

}  // namespace splatlas

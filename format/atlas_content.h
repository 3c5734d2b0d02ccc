// Everything an atlas holds, in memory: what preprocess makes and the writer takes.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "format/class_table.h"
#include "format/grid.h"
#include "format/structure_graph.h"
#include "format/surface.h"
#include "format/unit_vector.h"
#include "format/voxel_type.h"

namespace splatlas {

/// A named view of a named selection: one step of a lesson.
struct Scene {
  std::string name;
  std::string caption;
  std::string selection;  ///< selection text
  double azimuth_deg = 0, elevation_deg = 0, zoom = 1;
  friend bool operator==(const Scene&, const Scene&) = default;
};

/// Where the data came from: a whitelist, nothing of a source's own metadata is copied (no patient data).
struct Source {
  std::string role;  ///< "volume", "labels", "names", "tree", "mesh"
  std::string hash;  ///< "xxh64:<16 hex digits>" of the file's bytes
  friend bool operator==(const Source&, const Source&) = default;
};
struct Provenance {
  std::string title, citation, licence;  ///< as the author gave them
  std::string tool;                      ///< "splatlas-preprocess 0.1.0"
  std::vector<Source> sources;
  friend bool operator==(const Provenance&, const Provenance&) = default;
};

/// The grey values that a volume transfer function spreads over by default, and what a camera frames.
struct Display {
  double window_low = 0, window_high = 1;  ///< grey values
  Vec3 center_lps_mm{0, 0, 0};             ///< of the ball around every voxel of a structure
  double radius_mm = 1;                    ///< of that ball, voxels' corners included
  friend bool operator==(const Display&, const Display&) = default;
};

/// Volumes are in the storage grid (see storage_order), i fastest.
struct AtlasContent {
  Grid source_grid;             ///< of the files that were read, exactly
  AxisOrder source_to_storage;  ///< storage grid = reordered(source_grid, source_to_storage)
  StructureGraph graph;
  ClassTable classes;  ///< already in storage_order(classes, graph)
  std::vector<ClassId> class_volume;
  VoxelBuffer values;                       ///< grey values of every voxel; empty() when there is no volume
  VoxelType label_type = VoxelType::kNone;  ///< pixel type of the source label map; kNone: there was none
  std::vector<SurfaceMesh> surfaces;        ///< per structure; empty meshes for groups
  /// One per voxel of a class with a boundary membership, in memory order class by class (class order).
  std::vector<std::vector<PackedNormal>> boundary_normals;  ///< [class][n-th voxel of the class]
  Display display;
  std::vector<Scene> scenes;
  Provenance provenance;
};

/// Storage grid of the content.
[[nodiscard]] inline Grid storage_grid(const AtlasContent& content) {
  return reordered(content.source_grid, content.source_to_storage);
}

}  // namespace splatlas

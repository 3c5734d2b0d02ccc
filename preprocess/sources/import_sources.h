// Source files of a build, their import, what they hold, and their grid.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "format/content/atlas_content.h"
#include "preprocess/classify/segment_volume.h"
#include "preprocess/import/images/pixels/source_image.h"
#include "preprocess/import/membership_volume.h"
#include "preprocess/import/meshes/import_mesh.h"
#include "preprocess/import/notes.h"
#include "preprocess/import/tables/names_table.h"
#include "preprocess/surfaces/clip_mesh.h"

namespace splatlas {

/// The grid that stays where labels and volume have different ones.
enum class ResampleTo {
  kAsk,     ///< that of the labels, with a warning
  kLabels,  ///< grey values are interpolated linearly at the voxels of the labels
  kVolume,  ///< labels are taken from the voxel that lies nearest
};

/// A label map or a folder of masks.
struct LabelsFile {
  std::string group;  ///< that its structures are below; empty for none
  std::filesystem::path file;
};

/// Parses FILE or NAME=FILE. A path that exists is a FILE, and a NAME has no "/".
[[nodiscard]] LabelsFile parse_labels(const std::string& text);

/// Source files from the command line. Empty paths are not given.
struct SourceFiles {
  std::filesystem::path labels;         ///< a label map, or a folder of masks
  std::string labels_group;             ///< as of LabelsFile
  std::vector<LabelsFile> more_labels;  ///< beside `labels`; then all have groups
  std::filesystem::path volume, names, tree;
  std::filesystem::path sides;  ///< image of the sides of labels, or "x=MM"
  std::vector<SegmentRule> segments;
  std::vector<MeshSource> meshes;
  std::vector<std::filesystem::path> scenes;  ///< of read_scenes(); names may not repeat
  bool fit_grid = false;                      ///< widens the grid for surfaces that reach beyond it
  NamesFormat names_format = NamesFormat::kAuto;
  bool allow_empty = false;
  bool as_labels = false;                  ///< overrules the doubt that labels are grey values
  ImageOptions volume_options;             ///< of `volume`
  std::optional<Vec3> spacing_mm;          ///< of stacks of pictures, for labels and volume
  ResampleTo resample = ResampleTo::kAsk;  ///< where labels and volume are on different grids
};

/// Imported sources. Volumes are in the storage order of `source_grid`. Source numbers of structures: labels
/// or masks first, then segments, then meshes.
struct SourceModel {
  Grid source_grid;
  [[nodiscard]] Grid storage_grid() const { return reordered(source_grid, storage_order(source_grid)); }
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
};

/// The box of a mesh's corners in LPS mm.
[[nodiscard]] MmBox box_of(const TriangleMesh& mesh);
/// The box of the labelled voxels in LPS mm, from edge to edge; else that of the grid; else none.
[[nodiscard]] std::optional<MmBox> labelled_box(const SourceModel& model);

/// Warns of a surface smaller than a voxel, or 100 times smaller or larger than the labels; names a scale.
void note_size(const SourceModel& model, const MeshSource& source, const TriangleMesh& mesh,
               const MmBox& labelled, Notes& notes);

/// Makes a grid around the meshes if the model has none. With `widens`, adds voxels to its grid until it
/// holds all meshes: background, and the least grey value. Notes it. kLimit beyond 8 times the voxels.
[[nodiscard]] Result<void> fit_grid(SourceModel& model, std::span<const TriangleMesh> meshes, bool widens,
                                    Notes& notes);

/// Sides of the voxels at the plane x = `x_mm` in LPS: 1 (left) where x is larger, or equal, else 2.
[[nodiscard]] std::vector<std::uint8_t> sides_of_plane(const Grid& grid, double x_mm);
/// Sides of an image of 1 (left), 2 (right) and 0, as of BrainGlobe. kFailed, with the value, for others, and
/// if a side has no voxel. Messages call the image `file`.
[[nodiscard]] Result<std::vector<std::uint8_t>> sides_of_image(const VoxelBuffer& image,
                                                               const std::filesystem::path& file);
/// Moves the voxels of each structure that has 1 % of them or more on both sides to structures "NAME left"
/// and "NAME right" (SourceStructure::whole). Voxels on no side stay. Notes them, or that there are none.
void split_sides(SourceModel& model, std::span<const std::uint8_t> sides, const std::string& where,
                 Notes& notes);

/// Reads and checks the files, all of them even if one fails: the error is the first one, and `notes` has the
/// others. Masks of segments on other grids are resampled to the nearest voxel. `progress` receives the
/// fraction done and may be empty. Call it while this process has one thread (isolation/run_isolated.h).
[[nodiscard]] Result<SourceModel> import_sources(const SourceFiles& files, Notes& notes,
                                                 const std::function<void(double)>& progress = {});

/// All files that import_sources() would read, including those in folders.
[[nodiscard]] std::vector<std::filesystem::path> list_files(const SourceFiles& files);

}  // namespace splatlas

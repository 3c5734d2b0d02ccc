// Importer of labels (label map, segmentation file, or folder with a mask per structure) and their names.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "format/content/voxel_type.h"
#include "preprocess/import/images/pixels/source_image.h"
#include "preprocess/import/membership_volume.h"
#include "preprocess/import/notes.h"
#include "preprocess/import/tables/names_table.h"

namespace splatlas {

/// Sizes of a structure before and after its voxels moved to another grid.
struct ResampledStructure {
  std::string name;                   ///< in the file
  std::optional<std::int64_t> label;  ///< empty for masks
  std::uint64_t voxels_before = 0, voxels_after = 0;
  double ml_before = 0, ml_after = 0;
};

/// Voxels are in the storage order of `source_grid`; structures have source numbers.
struct ImportedLabels {
  Grid source_grid;
  std::size_t frame_of_reference = 0;  ///< as of SourceImage
  std::string source;                  ///< the file with the grid, for messages
  VoxelType type = VoxelType::kNone;   ///< of the label map; kNone for masks and overlapping segments
  MembershipVolume memberships{Index3{0, 0, 0}};
  std::vector<SourceStructure> structures;
  std::vector<std::filesystem::path> files;   ///< the files read, in a fixed order
  std::vector<ResampledStructure> resampled;  ///< import_sources() notes them, under their final names
  std::string doubt;  ///< which file looks like grey values, and why; names for all labels overrule it
  Notes notes;
};

/// Every value above 0 is a structure: named by the file's segments, else "Label 7". `name` stands for the
/// file in messages. Values within 1e-3 of a whole number are rounded, with `as_labels` all of them, and NaN
/// and infinity are background, each with a note. Doubts grey values: at least 64 values of which neighbours
/// mostly differ. kFailed, with the value, for labels that are negative, fractional, or 2^32 and above, and
/// for several layers.
[[nodiscard]] Result<ImportedLabels> read_label_map(SourceImage image, const std::string& name,
                                                    bool as_labels = false);

/// Gives structures the names, codes, colours and terms of `names`: by label, or masks by name or key. Notes
/// count labels without a name, shared names and colours, and names without voxels; those are dropped, or
/// become empty structures with `keeps_empty`. kFailed, with the first, if no name fits a structure.
[[nodiscard]] Result<void> name_labels(ImportedLabels& labels, NamesTable table, bool keeps_empty);

/// Notes voxels and volumes of each structure before and after resampling, the largest relative change first.
/// Structures have the `names` of the table.
void note_resampled(const ImportedLabels& labels, std::span<const LabelName> names, Notes& notes);

/// kFailed, with the doubt, if labels look like grey values and one has no name.
[[nodiscard]] Result<void> check_doubt(const ImportedLabels& labels);

/// Reads what `path` holds: label maps (read_label_map()), segmentations, or masks. Every segment is a
/// structure; those of several layers may overlap, and the larger come first; those of one layer keep their
/// value as label. Notes count segments without voxels, which are dropped, and voxels of values without a
/// segment. With `grid`, labels on another grid are resampled to it, to the nearest voxel;
/// ImportedLabels::resampled tells the structures' voxels and volumes before and after.
[[nodiscard]] Result<ImportedLabels> import_labels(const std::filesystem::path& path,
                                                   ImageOptions options = {},
                                                   const std::optional<Grid>& grid = std::nullopt);

/// Imports a folder with one mask per structure, as TotalSegmentator writes: a structure has the name of its
/// file and the voxels that are not 0. Masks may overlap; larger ones come first. Files with more than 16
/// values, or negative ones, hold grey values and are left out; empty masks are dropped; both are counted in
/// notes. All masks have the grid `grid`, or the most frequent one; others are resampled to the nearest
/// voxel, with a note. kFailed for files that cannot be read, for two names that differ in case only, and if
/// no mask has a voxel.
[[nodiscard]] Result<ImportedLabels> import_mask_folder(const std::filesystem::path& folder,
                                                        const std::optional<Grid>& grid = std::nullopt);

/// Adds the structures of another label map. Both move to the smallest grid that holds them; where they
/// overlap, voxels are in both. kFailed unless the voxels of both lie on one lattice.
[[nodiscard]] Result<void> add_labels(ImportedLabels others, ImportedLabels& labels);

}  // namespace splatlas

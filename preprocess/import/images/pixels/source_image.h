// Content of an image file, as its reader hands it over.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "format/content/grid.h"
#include "format/content/voxel_type.h"
#include "preprocess/import/notes.h"
#include "preprocess/import/tables/names_table.h"

namespace splatlas {

/// A structure that a file names: the voxels of one value in one layer.
struct SourceSegment {
  std::size_t layer = 0;
  std::int64_t value = 1;
  SourceStructure structure;  ///< its label is empty
};

/// Layers of voxels on one grid, and what the file says of them. A volume has one layer, a series of volumes
/// one per volume, a segmentation as many as its overlaps need.
struct SourceImage {
  Grid grid;                           ///< LPS
  std::size_t frame_of_reference = 0;  ///< a hash of DICOM's UID; 0 if unknown
  VoxelBuffer voxels;                  ///< layer after layer, i fastest
  std::size_t layers = 1;
  std::vector<SourceSegment> segments;  ///< names of values; empty for images
  bool is_segmentation = false;         ///< only values of `segments` are structures
  Notes notes;
};

/// Options that readers need. Those that do not concern a format are ignored by it.
struct ImageOptions {
  std::string series = {};  ///< DICOM: number in the list of stacks, from 1, or UID; empty for the only one
  std::optional<std::size_t> component = {};  ///< volume of a file of several, from 1
  std::optional<Vec3> spacing_mm = {};        ///< of stacks of pictures, which have none
  bool as_labels = false;                     ///< values of a label map are rounded, whatever they look like
  bool labels = false;  ///< of a DICOM folder with both, the segmentation is wanted and not the image
  std::optional<Grid> grid = {};  ///< of contours, which have none
};

// Members, for archives.

void transfer(auto& archive, Term& term) {
  archive(term.vocabulary, term.value);
}
void transfer(auto& archive, SourceStructure& structure) {
  archive(structure.name, structure.label, structure.code, structure.color, structure.external,
          structure.terms);
}
void transfer(auto& archive, Note& note) {
  archive(note.kind, note.items);
}
void transfer(auto& archive, VoxelBuffer& voxels) {
  archive(voxels.type, voxels.bytes);
}
void transfer(auto& archive, SourceSegment& segment) {
  archive(segment.layer, segment.value, segment.structure);
}
void transfer(auto& archive, SourceImage& image) {
  archive(image.grid, image.frame_of_reference, image.voxels, image.layers, image.segments,
          image.is_segmentation, image.notes);
}

}  // namespace splatlas

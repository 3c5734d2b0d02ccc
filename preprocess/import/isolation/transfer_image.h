// Members of SourceImage, for archives.
#pragma once

#include "preprocess/import/images/source_image.h"

namespace splatlas {

void transfer(auto& archive, Grid& grid) {
  archive(grid.size, grid.spacing_mm, grid.origin_lps_mm, grid.direction_lps);
}
void transfer(auto& archive, VoxelBuffer& voxels) {
  archive(voxels.type, voxels.bytes);
}
void transfer(auto& archive, Rgb& color) {
  archive(color.r, color.g, color.b);
}
void transfer(auto& archive, SourceTerm& term) {
  archive(term.vocabulary, term.value);
}
void transfer(auto& archive, SourceStructure& structure) {
  archive(structure.name, structure.label, structure.code, structure.color, structure.external,
          structure.terms);
}
void transfer(auto& archive, SourceSegment& segment) {
  std::uint64_t layer = segment.layer;
  archive(layer, segment.value, segment.structure);
  segment.layer = static_cast<std::size_t>(layer);
}
void transfer(auto& archive, NoteKind& kind) {
  archive(kind.id, kind.one, kind.many, kind.is_warning);
}
void transfer(auto& archive, Note& note) {
  archive(note.kind, note.items);
}
void transfer(auto& archive, SourceImage& image) {
  std::uint64_t layers = image.layers;
  archive(image.grid, image.voxels, layers, image.segments, image.is_segmentation, image.notes);
  image.layers = static_cast<std::size_t>(layers);
}

}  // namespace splatlas

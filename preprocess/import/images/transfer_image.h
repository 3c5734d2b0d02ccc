// Members of SourceImage, for archives.
#pragma once

#include "preprocess/import/images/pixels/source_image.h"
#include "preprocess/import/tables/transfer_tables.h"

namespace splatlas {

void transfer(auto& archive, Grid& grid) {
  archive(grid.size, grid.spacing_mm, grid.origin_lps_mm, grid.direction_lps);
}
void transfer(auto& archive, VoxelBuffer& voxels) {
  archive(voxels.type, voxels.bytes);
}
void transfer(auto& archive, SourceSegment& segment) {
  std::uint64_t layer = segment.layer;
  archive(layer, segment.value, segment.structure);
  segment.layer = static_cast<std::size_t>(layer);
}
void transfer(auto& archive, SourceImage& image) {
  std::uint64_t layers = image.layers;
  archive(image.grid, image.voxels, layers, image.segments, image.is_segmentation, image.notes);
  image.layers = static_cast<std::size_t>(layers);
}

}  // namespace splatlas

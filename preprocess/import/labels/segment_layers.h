// Structures of segmentation files.
#pragma once

#include <string>

#include "preprocess/import/images/pixels/source_image.h"
#include "preprocess/import/labels/imported_labels.h"

namespace splatlas {

/// Every segment of the file is a structure; segments of several layers may overlap. Segments of one layer
/// keep their value as label. Larger structures come first where there are several layers. Notes count
/// segments without voxels, which are dropped, and voxels of values without a segment. Cost: a pass a layer.
[[nodiscard]] Result<ImportedLabels> read_segments(SourceImage image, const std::string& name);

/// Sorts structures by descending number of voxels, so that the more specific of two that overlap has the
/// higher number.
void sort_by_size(ImportedLabels& labels, const std::vector<std::uint64_t>& counts);

}  // namespace splatlas

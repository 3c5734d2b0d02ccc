// Names of labels in extensions of NIfTI headers.
#pragma once

#include <string_view>
#include <vector>

#include "preprocess/import/images/pixels/source_image.h"

namespace splatlas {

/// The labels of a LabelTable (Caret's XML, as TotalSegmentator and Mango write it) in the bytes between
/// header and voxels; none if there is no such table. Their colours are dropped: TotalSegmentator repeats a
/// cycle of twelve. Only numbers and names are kept: other parts of the XML may hold names of patients.
[[nodiscard]] std::vector<SourceSegment> labels_of_extensions(std::string_view extensions);

}  // namespace splatlas

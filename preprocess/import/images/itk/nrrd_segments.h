// Segments of 3D Slicer's segmentation files (.seg.nrrd).
#pragma once

#include <map>
#include <string>
#include <vector>

#include "preprocess/import/images/pixels/source_image.h"

namespace splatlas {

/// The segments that the key/value pairs of an NRRD header name (3D Slicer's developer guide, segmentations),
/// by number. Files before Slicer 4.11 have no values and layers: segment N is the value 1 of layer N.
/// Terminology entries become terms: the code of the type, and of its modifier.
[[nodiscard]] std::vector<SourceSegment> segments_of_nrrd(const std::map<std::string, std::string>& pairs);

}  // namespace splatlas

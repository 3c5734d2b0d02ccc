// The list of segments of a DICOM segmentation.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "format/content/color.h"
#include "format/result.h"
#include "preprocess/import/images/pixels/source_image.h"

namespace splatlas {

enum class SegmentationKind { kBinary, kFractional, kLabelMap };

struct SegmentList {
  SegmentationKind kind = SegmentationKind::kBinary;
  std::int32_t max_fraction = 255;      ///< of kFractional
  std::int32_t background = 0;          ///< of kLabelMap
  std::vector<SourceSegment> segments;  ///< by their values, which are the segment numbers
  Notes notes;
};

/// Reads the header of a segmentation. kFailed for unknown kinds, and segment numbers that repeat or are out
/// of range. Only labels, colours and codes of the header are returned.
[[nodiscard]] Result<SegmentList> read_segments(const std::filesystem::path& path);

/// sRGB colour of a RecommendedDisplayCIELabValue, for the white point D65 that writers of segmentations use.
/// Colours outside sRGB are clamped.
[[nodiscard]] Rgb color_of_lab(const std::array<double, 3>& encoded);

}  // namespace splatlas

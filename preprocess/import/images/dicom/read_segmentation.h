// DICOM segmentations: masks, fractions and label maps.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "format/content/color.h"
#include "format/result.h"
#include "preprocess/import/images/dicom/stack_frames.h"
#include "preprocess/import/images/pixels/source_image.h"

namespace splatlas {

/// The structures and voxels of a segmentation: uint8, or uint16 for segment numbers above 255. BINARY
/// segments are masks; FRACTIONAL ones are masks of the voxels above one half of the maximum; a LABELMAP
/// holds segment numbers, and its padding value is background. A segment that overlaps others goes to the
/// first layer in which it overlaps none. Slices without a frame are empty. Structures have the segment's
/// label, colour and codes: {"SNOMED", "23451007"}, {"modifier SNOMED", "7771000"}. A label that cannot be a
/// name becomes "segment N", with a note. kFailed for damaged files, unknown kinds, and segment numbers that
/// repeat or are not listed. Cost: each frame is decoded once; memory for the layers and the largest segment.
/// One thread at a time.
[[nodiscard]] Result<SourceImage> read_segmentation(SlicedStack stack, const std::filesystem::path& path);

/// A segment of a file; "segment 7", with a note, if its label cannot be a name.
[[nodiscard]] SourceSegment named_segment(std::string label, std::int64_t number, Notes& notes);

/// sRGB colour of a RecommendedDisplayCIELabValue, for the white point D65 that writers of segmentations use.
/// Colours outside sRGB are clamped.
[[nodiscard]] Rgb color_of_lab(const std::array<double, 3>& encoded);

}  // namespace splatlas

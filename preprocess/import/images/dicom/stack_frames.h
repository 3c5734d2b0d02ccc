// Stacks of frames: which frames make up one volume, and its grid.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "format/content/grid.h"
#include "format/result.h"
#include "preprocess/import/images/dicom/dicom_frame.h"
#include "preprocess/import/images/dicom/read_frames.h"
#include "preprocess/import/notes.h"

namespace splatlas {

/// Frames of one volume, in the order of the files. They point into the list that was grouped.
struct FrameStack {
  std::vector<const DicomFrame*> frames;
  std::string part;  ///< of a series that was split: "echo 1 of 2"; else empty
};

/// Groups frames by series, frame of reference, size, orientation (within 1e-3) and pixel spacing (1e-4); a
/// segmentation file is a group. Where positions repeat or steps are uneven, splits a group by the first of
/// its kinds (SplitKey, then pairs of them) that leaves even stacks of two and more slices which interleave.
/// In order of series number and file.
[[nodiscard]] std::vector<FrameStack> group_frames(std::span<const DicomFrame> frames);

/// "CT 512x512x93, 3.2x3.2x1.5 mm", with the part. The number of slices counts positions.
[[nodiscard]] std::string description(const FrameStack& stack);

/// A grid and its frames.
struct SlicedStack {
  Grid grid;           ///< LPS; a tilted stack has a sheared direction
  double step_mm = 1;  ///< along the normal
  std::vector<std::vector<const DicomFrame*>>
      slices;  ///< then all frames there, in the order of the files; one slice for each k of a segmentation
  std::vector<double> places;  ///< of an image's slices along k, ascending: 0, 1, 2, ... unless uneven
  Notes notes;
};

/// Slices of which some may be missing, or of which empty ones are left out (segmentations).
enum class SliceGaps { kMissing, kEmpty };

/// Orders a stack by position along the normal and derives the grid. Its step is the least one; in
/// segmentations it is SpacingBetweenSlices if all positions are multiples of it. A warning tells of missing
/// slices and uneven steps, with the tilt. kFailed, with `path` and position, for slices off the line.
/// Notes tilt: slices that are moved by more than 1e-3 of the step against the normal.
[[nodiscard]] Result<SlicedStack> slice_stack(const FrameStack& stack, SliceGaps gaps,
                                              const std::filesystem::path& path);

/// Row x column: where slices come to lie in a right-handed grid.
[[nodiscard]] Vec3 normal_of(const DicomFrame& frame);
/// "(0, 0, 12.5)", for messages.
[[nodiscard]] std::string position_text(const Vec3& position_lps_mm);
/// Notes a frame that is ignored for another one at its position.
void note_duplicate(const DicomFrame& frame, Notes& notes);

}  // namespace splatlas

// Stacks of frames: which frames make up one volume, and its grid.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "format/content/grid.h"
#include "format/result.h"
#include "preprocess/import/images/dicom/read_frames.h"
#include "preprocess/import/notes.h"

namespace splatlas {

/// Frames of one volume, in the order of the files. They point into the list that was grouped.
struct FrameStack {
  std::vector<const DicomFrame*> frames;
  std::string part;  ///< of a series that was split: "echo 1 of 2"; else empty
};

/// Groups frames by series, size, orientation (within 1e-3) and pixel spacing (1e-4); a segmentation file is
/// a group. Where positions repeat or steps are uneven, splits a group by the first of its kinds (SplitKey,
/// then pairs of them) that leaves even stacks of two and more slices. Ordered by series number, then by
/// file.
[[nodiscard]] std::vector<FrameStack> group_frames(std::span<const DicomFrame> frames);

/// "CT 512x512x93, 3.2x3.2x1.5 mm", with the part. The number of slices counts positions.
[[nodiscard]] std::string description(const FrameStack& stack);

/// A grid and the frames of each of its slices.
struct SlicedStack {
  Grid grid;  ///< LPS; a tilted stack has a sheared direction
  std::vector<std::vector<const DicomFrame*>>
      slices;  ///< k, then all frames there, in the order of the files
  Notes notes;
};

/// Slices that must all be there, or slices of which empty ones are left out (segmentations).
enum class SliceGaps { kMissing, kEmpty };

/// Orders a stack by position along the normal and derives the grid. The step is the median of all steps. In
/// segmentations it is SpacingBetweenSlices if all positions are multiples of it, else the least step.
/// kFailed, with `path` and positions, for missing slices, uneven steps and slices off the line.
/// Notes tilt: slices that are moved by more than 1e-3 of the step against the normal.
[[nodiscard]] Result<SlicedStack> slice_stack(const FrameStack& stack, SliceGaps gaps,
                                              const std::filesystem::path& path);

}  // namespace splatlas

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

/// Groups frames by series, size, orientation (within 1e-3) and pixel spacing (1e-4); a segmentation file is
/// a group. Where positions repeat or steps are uneven, splits a group by the first of its kinds (SplitKey,
/// then pairs of them) that leaves even stacks of two and more slices. In order of series number and file.
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

/// Positions within this distance are one, in mm.
inline constexpr double kSamePosition = 1e-3;

/// The frames at one position.
struct SlicePosition {
  double height = 0;  ///< mm along the normal
  std::vector<const DicomFrame*> frames;
};

/// Row x column: where slices come to lie in a right-handed grid.
[[nodiscard]] Vec3 normal_of(const DicomFrame& frame);
/// Positions in ascending order along the first frame's normal. Those within kSamePosition are one.
[[nodiscard]] std::vector<SlicePosition> slice_positions(std::span<const DicomFrame* const> frames);

/// The steps between positions, compared with the median of them.
struct SliceSteps {
  double median_mm = 0;             ///< 0 for one position
  std::size_t missing = 0;          ///< slices that are left out between others
  std::vector<std::size_t> gaps;    ///< steps of several times the median, by their first position
  std::vector<std::size_t> uneven;  ///< other steps
  [[nodiscard]] bool is_even() const { return gaps.empty() && uneven.empty(); }
};
[[nodiscard]] SliceSteps slice_steps(std::span<const SlicePosition> positions);

/// Maximum deviation of a slice: 1 % of the step, at least the rounding of 0.01 mm in positions.
[[nodiscard]] double max_deviation_mm(double step_mm);

/// "(0, 0, 12.5)", for messages.
[[nodiscard]] std::string position_text(const Vec3& position_lps_mm);
/// Notes a frame that is ignored for another one at its position.
void note_duplicate(const DicomFrame& frame, Notes& notes);

}  // namespace splatlas

// Positions of slices along their normal, and the steps between them.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "format/content/grid.h"
#include "preprocess/import/images/dicom/dicom_frame.h"

namespace splatlas {

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

/// Maximum deviation of a slice from its place: 1 % of the step, at least the rounding of 0.01 mm in
/// positions.
[[nodiscard]] double max_deviation_mm(double step_mm);

/// "(0, 0, 12.5)", for messages.
[[nodiscard]] std::string position_text(const Vec3& position_lps_mm);

}  // namespace splatlas

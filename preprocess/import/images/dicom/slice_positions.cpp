#include "preprocess/import/images/dicom/slice_positions.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

namespace splatlas {

Vec3 normal_of(const DicomFrame& frame) {
  const Vec3 &r = frame.row, &c = frame.column;
  return {r[1] * c[2] - r[2] * c[1], r[2] * c[0] - r[0] * c[2], r[0] * c[1] - r[1] * c[0]};
}

std::vector<SlicePosition> slice_positions(std::span<const DicomFrame* const> frames) {
  if (frames.empty()) return {};
  const Vec3 normal = normal_of(*frames.front());
  std::vector<SlicePosition> sorted;
  for (const DicomFrame* frame : frames) {
    const double height = std::inner_product(normal.begin(), normal.end(), frame->position.begin(), 0.0);
    sorted.push_back({height, {frame}});
  }
  std::ranges::stable_sort(sorted, {}, &SlicePosition::height);
  std::vector<SlicePosition> positions;
  for (SlicePosition& next : sorted) {
    if (!positions.empty() && next.height - positions.back().height <= kSamePosition) {
      positions.back().frames.push_back(next.frames.front());
    } else {
      positions.push_back(std::move(next));
    }
  }
  return positions;
}

double max_deviation_mm(double step_mm) {
  constexpr double kShare = 0.01, kRounding = 0.01, kMaxShare = 0.05;
  return std::max(kShare * step_mm, std::min(kRounding, kMaxShare * step_mm));
}

SliceSteps slice_steps(std::span<const SlicePosition> positions) {
  SliceSteps steps;
  if (positions.size() < 2) return steps;
  std::vector<double> lengths;
  for (std::size_t n = 1; n < positions.size(); ++n)
    lengths.push_back(positions[n].height - positions[n - 1].height);
  std::vector<double> sorted = lengths;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>((sorted.size() - 1) / 2);
  std::ranges::nth_element(sorted, middle);
  steps.median_mm = *middle;
  for (std::size_t n = 0; n < lengths.size(); ++n) {
    const double times = std::round(lengths[n] / steps.median_mm);
    const double deviation = std::abs(lengths[n] - times * steps.median_mm);
    if (times < 1 || deviation > max_deviation_mm(times * steps.median_mm)) {
      steps.uneven.push_back(n);
    } else if (times > 1) {
      steps.gaps.push_back(n);
      steps.missing += static_cast<std::size_t>(times) - 1;
    }
  }
  return steps;
}

std::string position_text(const Vec3& position_lps_mm) {
  const auto rounded = [](double mm) { return std::round(mm * 1000) / 1000 + 0.0; };  // never -0
  return fmt::format("({}, {}, {})", rounded(position_lps_mm[0]), rounded(position_lps_mm[1]),
                     rounded(position_lps_mm[2]));
}

}  // namespace splatlas

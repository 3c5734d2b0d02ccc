// Sliding window of grey values and prediction errors: three slices of a group's box. Shared by the encoder
// and the decoder of value_codec.cpp.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include "format/codec/value_filter.h"
#include "format/content/grid.h"
#include "format/content/run_model.h"

namespace splatlas {

/// Voxels of a slice of the box, padded by the reach of the neighbours.
[[nodiscard]] inline std::uint64_t window_voxels(const IndexBox& box) {
  return static_cast<std::uint64_t>(box.last[0] - box.first[0] + 3) *
         static_cast<std::uint64_t>(box.last[1] - box.first[1] + 4);
}

/// Prediction parameters of a group.
struct ValueModel {
  ValueWeights weights{};
  std::uint8_t error_shift = 0;  ///< errors are stored divided by 2^error_shift
};

/// Prediction of a voxel.
struct ValuePrediction {
  std::int32_t value;
  std::uint8_t errors;  ///< sum of the errors of kErrorNeighbours neighbours, at most 255
  std::int32_t before;  ///< value of the previous voxel
  std::size_t in_run;   ///< index of the voxel in the run
};

/// Lane: int16_t for 8-bit values, int32_t for 16-bit values.
template <typename Lane>
class ValueWindow {
 public:
  static constexpr std::int32_t kMaxValue = sizeof(Lane) == 2 ? 0xff : 0xffff;

  ValueWindow(const IndexBox& box, const ValueModel& model)
      : box_(box), model_(model), width_(box.last[0] - box.first[0] + 3) {
    for (Slice& slice : slices_) {
      slice.values.assign(window_voxels(box) + kFilterPadding, kAbsent);
      slice.errors.assign(window_voxels(box) + kFilterPadding, kAbsentError);
    }
    sums_.resize(static_cast<std::size_t>(width_) + kFilterPadding);
    rest_.resize(sums_.size());
    errors_.resize(sums_.size());
    std::copy(model.weights.begin(), model.weights.end(), input_.weights.begin());
  }

  /// Moves to scanline (j, k). Call in scanline order.
  void go_to(std::int64_t j, std::int64_t k) {
    for (std::int64_t slices = std::min<std::int64_t>(k - k_, 3); slices > 0; --slices) {
      std::rotate(slices_.begin(), slices_.end() - 1, slices_.end());
      clear(slices_[0]);
    }
    k_ = k;
    row_ = (j - box_.first[1] + 2) * width_;
    std::vector<std::int64_t>& rows = slices_[0].rows;
    if (rows.empty() || rows.back() != row_) rows.push_back(row_);
  }

  /// Assigns code(prediction) to voxels begin to end - 1 of the scanline. Returns the values.
  template <typename Code>
  std::span<const Lane> code_run(std::int64_t begin, std::int64_t end, Code&& code) {
    const std::int64_t at = row_ + begin - box_.first[0] + 1;
    const auto count = static_cast<std::size_t>(end - begin);
    for (std::size_t q = 0; q < kNeighbours.size(); ++q) {
      input_.values[q] = neighbour(q).values.data() + at + offset(q);
      if (q < kErrorNeighbours) input_.errors[q] = neighbour(q).errors.data() + at + offset(q);
    }
    filter_run(input_, count, {sums_.data(), rest_.data(), errors_.data()});
    Lane* const values = slices_[0].values.data() + at;
    std::int32_t before = value_before(values);
    for (std::size_t n = 0; n < count; ++n) {
      // Sums may wrap around: only the bits below kMaxValue after the shift matter.
      const auto sum = static_cast<std::uint32_t>(sums_[n]) +
                       static_cast<std::uint32_t>(rest_[n]) * static_cast<std::uint32_t>(before);
      const std::int32_t predicted = static_cast<std::int32_t>(sum >> kWeightBits) & kMaxValue;
      const std::int32_t value = code(ValuePrediction{predicted, errors_[n], before, n});
      values[n] = static_cast<Lane>(value);
      sums_[n] = static_cast<Lane>(value - predicted);
      before = value;
    }
    before_ = before;
    keep_errors(slices_[0].errors.data() + at, count);
    return {values, count};
  }

  /// Neighbours' values relative to the previous voxel, 0 for absent ones. Only within code(prediction).
  [[nodiscard]] std::array<float, kNeighbours.size()> from_before(const ValuePrediction& prediction) const {
    std::array<float, kNeighbours.size()> values{};
    for (std::size_t q = 0; q < values.size(); ++q) {
      const std::int32_t value = input_.values[q][prediction.in_run];
      if (value >= 0) values[q] = static_cast<float>(value - prediction.before);
    }
    return values;
  }

  /// value - predicted, wrapped to the signed range of the value type.
  [[nodiscard]] static std::int32_t difference(std::int32_t value, std::int32_t predicted) {
    constexpr std::int32_t kHalf = (kMaxValue + 1) / 2;
    return ((value - predicted + kHalf) & kMaxValue) - kHalf;
  }

 private:
  static constexpr Lane kAbsent = -1;  // not in the group, or not decoded yet
  static constexpr std::uint8_t kAbsentError = 4;

  struct Slice {
    std::vector<Lane> values;
    std::vector<std::uint8_t> errors;
    std::vector<std::int64_t> rows;  // offsets of the rows in use
  };

  [[nodiscard]] const Slice& neighbour(std::size_t q) const {
    return slices_[static_cast<std::size_t>(-kNeighbours[q].k)];
  }
  [[nodiscard]] std::int64_t offset(std::size_t q) const {
    return kNeighbours[q].j * width_ + kNeighbours[q].i;
  }

  /// Previous value for the first voxel of a run: the voxel before it, else the nearest neighbour in the
  /// group, else the last coded voxel.
  [[nodiscard]] std::int32_t value_before(const Lane* values) const {
    if (values[-1] >= 0) return values[-1];
    for (const Lane* value : input_.values) {
      if (*value >= 0) return *value;
    }
    return before_;
  }

  /// Stores the errors of a run. sums_ contains its differences.
  void keep_errors(std::uint8_t* errors, std::size_t count) const {
    const Lane* const differences = sums_.data();
    const std::int32_t shift = model_.error_shift;
    for (std::size_t n = 0; n < count; ++n) {
      const std::int32_t error = std::abs(difference(differences[n], 0));
      errors[n] = static_cast<std::uint8_t>(std::min(error >> shift, 255));
    }
  }

  /// Clears only the rows in use: boxes may be large and sparse.
  void clear(Slice& slice) const {
    for (const std::int64_t row : slice.rows) {
      std::fill_n(slice.values.begin() + row, width_, kAbsent);
      std::fill_n(slice.errors.begin() + row, width_, kAbsentError);
    }
    slice.rows.clear();
  }

  const IndexBox box_;
  const ValueModel model_;
  const std::int64_t width_;
  std::array<Slice, 3> slices_;  // this one, the one before, and the one before that
  std::int64_t k_ = -4, row_ = 0;
  std::int32_t before_ = 0;  // last coded value
  FilterInput<Lane> input_{};
  std::vector<Lane> sums_, rest_;
  std::vector<std::uint8_t> errors_;
};

}  // namespace splatlas

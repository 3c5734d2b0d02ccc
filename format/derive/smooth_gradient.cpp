#include "format/derive/smooth_gradient.h"

#include <algorithm>
#include <cmath>

#include "format/tasks/task_control.h"

namespace splatlas {
namespace {

/// out[n] = sum over t of kernel[t] * in[n + t * stride].
template <std::size_t kTaps>
void convolve(const std::array<float, kTaps>& kernel, const float* in, std::size_t stride, std::size_t count,
              float* out) {
  for (std::size_t n = 0; n < count; ++n) {
    float sum = 0;
    for (std::size_t t = 0; t < kTaps; ++t) sum += kernel[t] * in[n + t * stride];
    out[n] = sum;
  }
}

}  // namespace

GradientKernels::GradientKernels() {
  double sum = 0, moment = 0;
  const auto gauss_at = [](double t) { return std::exp(-0.5 * t * t); };
  for (std::int64_t n = 0; n < kTaps; ++n) {
    const auto t = static_cast<double>(n - kRadius);
    sum += gauss_at(t);
    moment += t * t * gauss_at(t);
  }
  for (std::size_t n = 0; n < kTaps; ++n) {
    const double t = static_cast<double>(n) - kRadius;
    gauss[n] = static_cast<float>(gauss_at(t) / sum);
    derivative[n] = static_cast<float>(t * gauss_at(t) / moment);
  }
}

SmoothGradient::SmoothGradient(const StructureCrop& crop) : crop_(crop) {
  const auto width = static_cast<std::size_t>(crop.size[0]), height = static_cast<std::size_t>(crop.size[1]);
  row_.resize(width + kTaps - 1);
  rows_smooth_.resize(width * (height + kTaps - 1));
  rows_derived_.resize(rows_smooth_.size());
  for (Plane& plane : ring_) {
    for (auto* values : {&plane.smooth, &plane.along_j, &plane.along_i}) values->resize(width * height);
  }
  row_occupied_.resize(height + kTaps - 1);
}

void SmoothGradient::filter_row(std::int64_t j, std::int64_t k) {
  const auto width = static_cast<std::size_t>(crop_.size[0]);
  const std::uint8_t* const parts = &crop_.parts[crop_.offset(0, j, k)];
  const auto row = static_cast<std::size_t>(j + kRadius);
  const std::size_t at = row * width;
  row_occupied_[row] =
      std::any_of(parts, parts + width, [](std::uint8_t p) { return p != StructureCrop::kOutside; });
  if (row_occupied_[row] == 0) {
    std::fill_n(&rows_smooth_[at], width, 0.f);
    std::fill_n(&rows_derived_[at], width, 0.f);
    return;
  }
  for (std::size_t i = 0; i < width; ++i)
    row_[i + kRadius] = parts[i] != StructureCrop::kOutside ? 1.0f : 0.0f;
  convolve(kernels_.gauss, row_.data(), 1, width, &rows_smooth_[at]);
  convolve(kernels_.derivative, row_.data(), 1, width, &rows_derived_[at]);
}

void SmoothGradient::filter_plane(std::int64_t k) {
  check_task();
  Plane& plane = ring_[static_cast<std::size_t>(k % kTaps)];
  if (k >= crop_.size[2]) {  // outside the crop
    for (auto* values : {&plane.smooth, &plane.along_j, &plane.along_i})
      std::fill(values->begin(), values->end(), 0.f);
    return;
  }
  for (std::int64_t j = 0; j < crop_.size[1]; ++j) filter_row(j, k);
  const auto width = static_cast<std::size_t>(crop_.size[0]);
  for (std::size_t j = 0; j < static_cast<std::size_t>(crop_.size[1]); ++j) {
    const auto first = row_occupied_.begin() + static_cast<std::ptrdiff_t>(j);
    const std::size_t at = j * width;
    if (std::none_of(first, first + kTaps, [](std::uint8_t occupied) { return occupied != 0; })) {
      for (auto* values : {&plane.smooth, &plane.along_j, &plane.along_i})
        std::fill_n(&(*values)[at], width, 0.f);
      continue;
    }
    convolve(kernels_.gauss, &rows_smooth_[at], width, width, &plane.smooth[at]);
    convolve(kernels_.derivative, &rows_smooth_[at], width, width, &plane.along_j[at]);
    convolve(kernels_.gauss, &rows_derived_[at], width, width, &plane.along_i[at]);
  }
}

void SmoothGradient::next_slice() {
  for (; planes_made_ <= next_ + kRadius; ++planes_made_) filter_plane(planes_made_);
  // Planes before the first one are still zero in the ring.
  for (std::int64_t t = 0; t < kTaps; ++t) {
    planes_[static_cast<std::size_t>(t)] =
        &ring_[static_cast<std::size_t>((next_ + t - kRadius + kTaps) % kTaps)];
  }
  ++next_;
}

}  // namespace splatlas

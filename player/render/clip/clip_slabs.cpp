#include "player/render/clip/clip_slabs.h"

#include <algorithm>
#include <cmath>

namespace splatlas {
namespace {

/// Rays that approach the kept part by less, in voxels per slice, leave it: rounding decides the sign for
/// planes along the view.
constexpr double kMinEntering = 1e-6;

/// Interval of x in which a + b x > limit, within [low, high].
std::pair<double, double> above(double a, double b, double limit, double low, double high) {
  if (b == 0) return a > limit ? std::pair(low, high) : std::pair(high, low);
  const double at = (limit - a) / b;
  return b > 0 ? std::pair(std::max(low, at), high) : std::pair(low, std::min(high, at));
}

}  // namespace

ShearedPlane::ShearedPlane(const VoxelPlane& plane, const Shear& shear)
    : per_u(plane.normal[shear.scan.scan_axis]), per_v(plane.normal[shear.scan.row_axis]) {
  const double sheared = per_u * shear.slope_u + per_v * shear.slope_v;
  per_k = plane.normal[shear.scan.slice_axis] + sheared;
  at_origin = -plane.offset - sheared * shear.k_ref;
}

ClipSlabs::ClipSlabs(std::span<const VoxelPlane> planes, const Shear& shear, const SheetWindow& window,
                     std::int64_t margin)
    : shear_(shear), window_(window), margin_(margin) {
  const double thickness = 1.0 / window.parts, pixel = 1.0 / window.scale;
  for (const bool enters : {true, false}) {
    for (const VoxelPlane& plane : planes) {
      const ShearedPlane of(plane, shear);
      if (enters != ((shear.ascending ? of.per_k : -of.per_k) < -kMinEntering)) continue;
      const double across_slab = std::abs(of.per_k) * thickness;
      const double across_pixel = (std::abs(of.per_u) + std::abs(of.per_v)) * pixel - std::abs(of.per_k);
      const double scale = -1 / std::max(across_slab, across_pixel);
      ramps_.push_back({0.5 + scale * of.at_origin, scale * of.per_u, scale * of.per_v, scale * of.per_k});
      if (enters) ++entering_;
    }
  }
}

ClipSlabs::State ClipSlabs::state(double k, std::int64_t first_row, std::int64_t last_row) const {
  const double u = static_cast<double>(window_.u0), columns = static_cast<double>(window_.columns);
  const double v = static_cast<double>(window_.v0) + static_cast<double>(first_row) / window_.scale;
  const double rows = static_cast<double>(last_row - first_row) / window_.scale;
  State state = State::kWhole;
  for (const Ramp& ramp : ramps_) {
    const double corner = ramp.at_origin + ramp.per_u * u + ramp.per_v * v + ramp.per_k * k;
    const double along_u = ramp.per_u * columns, along_v = ramp.per_v * rows;
    if (corner + std::max(along_u, 0.0) + std::max(along_v, 0.0) <= 0) return State::kRemoved;
    if (corner + std::min(along_u, 0.0) + std::min(along_v, 0.0) < 1) state = State::kCut;
  }
  return state;
}

std::pair<std::int64_t, std::int64_t> ClipSlabs::visible_voxels(double k, std::int64_t row,
                                                                double slack) const {
  // A voxel reaches pixels less than one voxel away
  const double low = static_cast<double>(window_.u0) - 1;
  const double high = static_cast<double>(window_.u0 + window_.columns) + 1;
  const double v = static_cast<double>(row) + shear_.v_shift(k);
  double first = low, last = high;
  for (const Ramp& ramp : ramps_) {
    const double at = ramp.at_origin + ramp.per_v * v + ramp.per_k * k + std::abs(ramp.per_v) +
                      std::abs(ramp.per_k) * slack;
    const auto [from, to] = above(at, ramp.per_u, 0, low, high);
    first = std::max(first, from);
    last = std::min(last, to);
  }
  if (!(first < last)) return {0, 0};
  const double shift = shear_.u_shift(k);
  return {static_cast<std::int64_t>(std::floor(first - shift - 1 - slack)),
          static_cast<std::int64_t>(std::ceil(last - shift + 1 + slack)) + 1};
}

void ClipSlabs::Rows::fill(const ClipSlabs& slabs, double k, std::int64_t fine_row, std::int64_t pairs,
                           std::int64_t rows_between) {
  const SheetWindow& window = slabs.window_;
  columns_ = window.columns;
  rows_between_ = rows_between;
  phases_ = window.scale;
  entering_ = slabs.entering_;
  planes_ = static_cast<int>(slabs.ramps_.size());
  const double pixel = 1.0 / window.scale;
  const double low = -static_cast<double>(slabs.margin_);
  const double high = static_cast<double>(columns_ + slabs.margin_);
  pixels_.resize(static_cast<std::size_t>(pairs));
  lines_.resize(static_cast<std::size_t>(pairs * rows_between_ * phases_ * planes_));
  ClipLine* line = lines_.data();
  for (std::int64_t pair = 0; pair < pairs; ++pair) {
    double first_visible = high, last_visible = low, first_whole = low, last_whole = high;
    for (std::int64_t row = 0; row < rows_between_; ++row) {
      const double v =
          static_cast<double>(window.v0) + static_cast<double>(fine_row + pair * window.scale + row) * pixel;
      for (std::int64_t phase = 0; phase < phases_; ++phase) {
        const double u = static_cast<double>(window.u0) + static_cast<double>(phase) * pixel;
        double first = low, last = high;  // visible pixels of this phase row
        for (const Ramp& ramp : slabs.ramps_) {
          const double at = ramp.at_origin + ramp.per_u * u + ramp.per_v * v + ramp.per_k * k;
          const auto [from, to] = above(at, ramp.per_u, 0, low, high);
          first = std::max(first, from);
          last = std::min(last, to);
          const auto [whole_from, whole_to] = above(at, ramp.per_u, 1, low, high);
          first_whole = std::max(first_whole, whole_from);
          last_whole = std::min(last_whole, whole_to);
          // Anchor the line where it is 0
          const double zero = ramp.per_u == 0 ? 0 : std::clamp(-at / ramp.per_u, low, high);
          line->whole = static_cast<std::int32_t>(std::floor(zero));
          line->at_whole = static_cast<float>(at + ramp.per_u * line->whole);
          line->per_pixel = static_cast<float>(ramp.per_u);
          ++line;
        }
        if (!(first < last)) continue;
        first_visible = std::min(first_visible, first);
        last_visible = std::max(last_visible, last);
      }
    }
    ClipPixels& pixels = pixels_[static_cast<std::size_t>(pair)];
    pixels = {};
    if (first_visible < last_visible) {
      pixels.first_visible = static_cast<std::int64_t>(std::floor(first_visible));
      pixels.last_visible = static_cast<std::int64_t>(std::ceil(last_visible)) + 1;
    }
    if (first_whole < last_whole) {
      pixels.first_whole = static_cast<std::int64_t>(std::ceil(first_whole)) + (first_whole > low ? 1 : 0);
      pixels.last_whole = static_cast<std::int64_t>(std::floor(last_whole)) - (last_whole < high ? 1 : 0);
    }
  }
}

ClipSlabs::State ClipSlabs::Rows::state(std::int64_t pair) const {
  const ClipPixels& pixels = pixels_[static_cast<std::size_t>(pair)];
  if (pixels.last_visible <= std::max<std::int64_t>(pixels.first_visible, 0) ||
      pixels.first_visible >= columns_) {
    return State::kRemoved;
  }
  return pixels.first_whole <= 0 && pixels.last_whole >= columns_ ? State::kWhole : State::kCut;
}

ClipRows ClipSlabs::Rows::from(std::int64_t pair, std::int64_t phase) const {
  ClipRows rows;
  rows.entering = entering_;
  rows.planes = planes_;
  rows.phase_stride = planes_;
  rows.row_stride = phases_ * planes_;
  rows.pair_stride = rows_between_ * rows.row_stride;
  rows.pixels = pixels_.data() + pair;
  rows.lines = lines_.data() + pair * rows.pair_stride + phase * rows.phase_stride;
  return rows;
}

}  // namespace splatlas

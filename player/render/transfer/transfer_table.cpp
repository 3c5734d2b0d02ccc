#include "player/render/transfer/transfer_table.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>

namespace splatlas {
namespace {

template <typename T>
T load(const std::byte* values, std::size_t n) {
  T value;
  std::memcpy(&value, values + n * sizeof(T), sizeof(T));
  return value;
}

/// Curves over other types than bytes are scaled to the range of bytes.
constexpr double kStoredWidth = 255;
/// Largest magnitude of a control point: floats resolve 1/128 there. Distant, narrow curves are scaled down.
constexpr double kMaxStored = 1e5;
/// Limit for curves as narrow as the resolution of doubles, whose scale would be infinite.
constexpr double kMaxScale = 1e300;
/// Narrower ramps are steps, in stored grey values: a float cannot represent their slope.
constexpr double kMinRamp = 1e-20;
/// Share of a curve's width below which cancellation dominates the difference quotients of the integrals.
constexpr double kMinShare = 2e-4;

/// A control point over stored grey values, in double precision.
struct Knot {
  double grey = 0, extinction = 0, shade = 0;
};

}  // namespace

TransferShape shape_of(const TransferCurve& curve) {
  double densest = 0;
  for (const TransferPoint& point : curve.points)
    densest = std::max(densest, extinction_of(point.opacity, 1));
  TransferShape shape;
  shape.points.reserve(curve.points.size());
  for (const TransferPoint& point : curve.points) {
    const double extinction = densest > 0 ? extinction_of(point.opacity, 1) / densest : 0;
    shape.points.push_back({point.grey, extinction, static_cast<double>(point.shade)});
  }
  return shape;
}

TransferTable::TransferTable(const TransferShape& shape, VoxelType type, bool tabulated)
    : shape_(shape), type_(type) {
  if (!tabulated || type == VoxelType::kNone || bytes_of(type) > 2) return;
  visit_voxel_type(type, [&](auto tag) {
    using T = decltype(tag);
    if constexpr (sizeof(T) <= 2) {
      using Bits = std::make_unsigned_t<T>;
      lowest_ = std::numeric_limits<T>::lowest();
      highest_ = std::numeric_limits<T>::max();
      table_.resize(std::size_t{1} << (8 * sizeof(T)));
      for (std::size_t bits = 0; bits < table_.size(); ++bits) {
        table_[bits] = share_of(static_cast<double>(static_cast<T>(static_cast<Bits>(bits))));
      }
    }
  });
}

TransferShare TransferTable::share_of(double grey) const {
  using Point = TransferShape::Point;
  const auto to_share = [](double extinction, double shade) {
    return TransferShare{static_cast<float>(extinction), static_cast<float>(shade)};
  };
  const std::vector<Point>& points = shape_.points;
  // The negated comparison sorts NaN before all points.
  const auto above =
      std::upper_bound(points.begin(), points.end(), grey,
                       [](double value, const Point& point) { return !(value >= point.grey); });
  if (above == points.begin()) return to_share(points.front().extinction, points.front().shade);
  const Point& low = *(above - 1);
  if (above == points.end()) return to_share(low.extinction, low.shade);
  const Point& high = *above;
  // Interpolate linearly, with the operations of evaluate().
  const double of_high = (grey - low.grey) / (high.grey - low.grey);
  const double of_low = (high.grey - grey) / (high.grey - low.grey);
  return to_share(of_low * low.extinction + of_high * high.extinction,
                  of_low * low.shade + of_high * high.shade);
}

template <typename Take>
void TransferTable::for_each_share(const std::byte* values, std::size_t first, std::size_t stride,
                                   std::size_t count, const Take& take) const {
  if (type_ == VoxelType::kNone) {
    const TransferShare share = share_of(shape_.points.back().grey);
    for (std::size_t n = 0; n < count; ++n) take(n, share);
    return;
  }
  visit_voxel_type(type_, [&](auto tag) {
    using T = decltype(tag);
    if constexpr (sizeof(T) <= 2) {
      if (!table_.empty()) {
        const TransferShare* const table = table_.data();
        for (std::size_t n = 0; n < count; ++n)
          take(n, table[static_cast<std::make_unsigned_t<T>>(load<T>(values, first + n * stride))]);
        return;
      }
    }
    for (std::size_t n = 0; n < count; ++n)
      take(n, share_of(static_cast<double>(load<T>(values, first + n * stride))));
  });
}

void TransferTable::look_up(const std::byte* values, std::size_t first, std::size_t stride, std::size_t count,
                            float densest_per_mm, ClassifiedVoxel* voxels) const {
  for_each_share(values, first, stride, count, [=](std::size_t n, const TransferShare& share) {
    voxels[n] = {densest_per_mm * share.extinction, share.shade};
  });
}

void TransferTable::look_up(const std::byte* values, std::size_t first, std::size_t stride, std::size_t count,
                            float densest_per_mm, float* extinctions, float* emissions) const {
  for_each_share(values, first, stride, count, [=](std::size_t n, const TransferShare& share) {
    extinctions[n] = densest_per_mm * share.extinction;
    emissions[n] = extinctions[n] * share.shade;
  });
}

std::optional<GreyScale> grey_scale(const TransferCurve& curve, VoxelType type) {
  if (type == VoxelType::kNone || curve.points.empty()) return std::nullopt;
  const bool hides_zero = evaluate(curve, 0, 1).extinction_per_mm <= 0;
  const TransferPoint& first = curve.points.front();
  if (!hides_zero && first.opacity > 0) return std::nullopt;
  GreyScale scale;
  scale.offset = hides_zero ? 0 : first.grey;
  const double width = curve.points.back().grey - first.grey;
  const double max_distance =
      std::max(std::abs(first.grey - scale.offset), std::abs(curve.points.back().grey - scale.offset));
  if (hides_zero && type == VoxelType::kUInt8 && max_distance <= kMaxStored) {
    scale.bytes = true;
    return scale;
  }
  const double stretch = width > 0 ? kStoredWidth / width : 1;
  scale.scale = std::min({stretch, kMaxStored / max_distance, kMaxScale});
  return scale;
}

PreintegratedTransfer::PreintegratedTransfer(const TransferCurve& curve, const GreyScale& scale,
                                             double reference_length_mm)
    : points_(curve.points.size()) {
  const auto knot = [&](std::size_t n) {
    const TransferPoint& point = curve.points[n];
    return Knot{static_cast<float>(scale.stored(point.grey)),
                extinction_of(point.opacity, reference_length_mm), point.shade};
  };
  // Tabulate each segment and accumulate the integrals to its first point
  double depth = 0, emission = 0, variation = 0;
  for (std::size_t segment = 0; segment <= points_; ++segment) {
    const Knot from = knot(segment == 0 ? 0 : segment - 1);
    const bool inner = segment > 0 && segment < points_;
    const Knot to = inner ? knot(segment) : from;
    const double width = to.grey - from.grey;
    const bool ramp = inner && width >= kMinRamp;  // not a step
    const double extinction_slope = ramp ? (to.extinction - from.extinction) / width : 0;
    const double shade_slope = ramp ? (to.shade - from.shade) / width : 0;
    const std::array<double, kRows> column{from.grey,  from.extinction, extinction_slope,
                                           from.shade, shade_slope,     depth,
                                           emission,   variation,       std::abs(extinction_slope)};
    for (std::size_t row = 0; row < kRows; ++row) table_[row][segment] = static_cast<float>(column[row]);
    variation += std::abs(to.extinction - from.extinction);
    depth += width * (from.extinction + to.extinction) / 2;
    emission += width * ((from.extinction * from.shade + to.extinction * to.shade) / 3 +
                         (from.extinction * to.shade + to.extinction * from.shade) / 6);
  }
  min_difference_ = static_cast<float>(kMinShare * (knot(points_ - 1).grey - knot(0).grey));
}

float PreintegratedTransfer::extinction_at(float grey) const {
  const auto& greys = table_[kGrey];
  const auto segment = static_cast<std::size_t>(
      std::upper_bound(greys.begin() + 1, greys.begin() + 1 + static_cast<std::ptrdiff_t>(points_), grey) -
      (greys.begin() + 1));
  return table_[kExtinction][segment] + table_[kExtinctionSlope][segment] * (grey - table_[kGrey][segment]);
}

bool PreintegratedTransfer::shows(float low, float high) const {
  if (extinction_at(low) > 0 || extinction_at(high) > 0) return true;
  for (std::size_t n = 1; n <= points_; ++n) {
    if (table_[kGrey][n] > low && table_[kGrey][n] < high && table_[kExtinction][n] > 0) return true;
  }
  return false;
}

}  // namespace splatlas

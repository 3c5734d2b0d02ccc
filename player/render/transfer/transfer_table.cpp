#include "player/render/transfer/transfer_table.h"

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

}  // namespace splatlas

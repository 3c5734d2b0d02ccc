#include "format/content/transfer_curve.h"

#include <algorithm>

#include <fmt/format.h>

#include "format/result_macros.h"

namespace splatlas {

TransferValue evaluate(const TransferCurve& curve, double grey, double reference_length_mm) {
  if (curve.points.empty()) return {};
  const auto above =
      std::upper_bound(curve.points.begin(), curve.points.end(), grey,
                       [](double value, const TransferPoint& point) { return !(value >= point.grey); });
  const TransferPoint& low = above == curve.points.begin() ? *above : *(above - 1);
  const TransferPoint& high = above == curve.points.end() ? low : *above;
  const TransferValue at_low{extinction_of(low.opacity, reference_length_mm), low.shade};
  if (&low == &high) return at_low;
  const TransferValue at_high{extinction_of(high.opacity, reference_length_mm), high.shade};
  // Compute both weights from differences to avoid cancellation near a transparent point.
  const double high_weight = (grey - low.grey) / (high.grey - low.grey);
  const double low_weight = (high.grey - grey) / (high.grey - low.grey);
  return {low_weight * at_low.extinction_per_mm + high_weight * at_high.extinction_per_mm,
          low_weight * at_low.shade + high_weight * at_high.shade};
}

Result<void> check_curve(const TransferCurve& curve) {
  const std::vector<TransferPoint>& points = curve.points;
  if (points.empty()) return fail(ErrorCode::kUsage, "the curve has no points");
  if (points.size() > kMaxTransferPoints) {
    return fail(ErrorCode::kUsage, "the curve has {} points: at most {} are allowed", points.size(),
                kMaxTransferPoints);
  }
  for (std::size_t n = 0; n < points.size(); ++n) {
    const TransferPoint& point = points[n];
    const auto fault = [&](std::string_view what) {
      return fail(ErrorCode::kUsage, "point {} of the curve: {}", n + 1, what);
    };
    if (!std::isfinite(point.grey) || !std::isfinite(point.grey - points.front().grey)) {
      return fault(fmt::format("grey value {} is too large", point.grey));
    }
    if (n > 0 && !(point.grey > points[n - 1].grey)) {
      return fault(
          fmt::format("grey value {} must be above {}, the point before", point.grey, points[n - 1].grey));
    }
    if (!(point.opacity >= 0 && point.opacity <= kMaxVolumeOpacity)) {
      return fault(fmt::format("opacity {} must be from 0 to {}", point.opacity, kMaxVolumeOpacity));
    }
    if (!(point.shade >= 0 && point.shade <= 1)) {
      return fault(fmt::format("shade {} must be from 0 to 1", point.shade));
    }
  }
  return {};
}

}  // namespace splatlas

// Fuzz target: transfer functions of arbitrary numbers, from selections and display windows.
// Input: a byte of choices, window (2 f64), opacity (f32), low and high (f64), a grey value (f64), then
// points (f64 grey, f32 opacity, f32 shade).
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>

#include "format/content/transfer_curve.h"
#include "player/render/transfer/transfer_table.h"
#include "player/transfer_function.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/require.h"

namespace splatlas {
namespace {

bool has_rising_greys(const TransferCurve& curve) {
  for (std::size_t n = 0; n < curve.points.size(); ++n) {
    const double grey = curve.points[n].grey;
    if (!std::isfinite(grey) || !std::isfinite(grey - curve.points[0].grey)) return false;
    if (n > 0 && !(grey > curve.points[n - 1].grey)) return false;
  }
  return true;
}

/// The definition in transfer_curve.h.
bool is_curve(const TransferCurve& curve) {
  const auto in_range = [](const TransferPoint& p) {
    return p.opacity >= 0 && p.opacity <= kMaxVolumeOpacity && p.shade >= 0 && p.shade <= 1;
  };
  return !curve.points.empty() && curve.points.size() <= kMaxTransferPoints &&
         std::ranges::all_of(curve.points, in_range) && has_rising_greys(curve);
}

/// Values stay within those of the points.
void check_values(const TransferCurve& curve, double grey) {
  const TransferValue value = evaluate(curve, grey, 1);
  double densest = 0;
  for (const TransferPoint& p : curve.points) densest = std::max(densest, extinction_of(p.opacity, 1));
  require(value.extinction_per_mm >= 0 && value.extinction_per_mm <= densest * (1 + 1e-12),
          "an extinction out of range");
  require(value.shade >= 0 && value.shade <= 1 + 1e-12, "a shade out of range");
  const TransferShare share = TransferTable(shape_of(curve), VoxelType::kFloat64).share_of(grey);
  require(std::abs(share.extinction * densest - value.extinction_per_mm) <= 1e-6 * densest &&
              std::abs(share.shade - value.shade) <= 1e-6,
          "a table tells another value than the curve");
}

/// The pre-integrated table of ray casting.
void check_table(const TransferCurve& curve, VoxelType type) {
  const std::optional<GreyScale> scale = grey_scale(curve, type);
  if (!scale) return;
  const PreintegratedTransfer table(curve, *scale, 1);
  for (std::size_t row = 0; row < PreintegratedTransfer::kRows; ++row) {
    const float* numbers = table.row(static_cast<PreintegratedTransfer::Row>(row));
    for (std::size_t n = 0; n <= table.points(); ++n)
      require(std::isfinite(numbers[n]), "a number of the table is not finite");
  }
}

void fuzz_transfer_curves(FuzzInput input) {
  const auto choices = input.number<std::uint8_t>();
  Display display;
  display.window_low = input.number<double>();
  display.window_high = input.number<double>();
  if (!std::isfinite(display.window_low) || !std::isfinite(display.window_high))
    return;  // a directory cannot hold it
  StructureDraw draw{.mode = DrawMode::kVolume};
  draw.volume.profile = static_cast<TransferProfile>(choices % 3);
  const float opacity = input.number<float>();
  if ((choices & 4) != 0 && opacity > 0 && opacity <= 1) draw.opacity = opacity;
  const double low = input.number<double>(), high = input.number<double>(), grey = input.number<double>();
  const bool has_width = (choices & 24) != 24 || low < high;
  if ((choices & 8) != 0 && std::isfinite(low) && has_width) draw.volume.low = low;
  if ((choices & 16) != 0 && std::isfinite(high) && has_width) draw.volume.high = high;

  TransferCurve written;
  while (!input.empty()) {
    written.points.push_back({input.number<double>(), input.number<float>(), input.number<float>()});
  }
  const auto checked = check_curve(written);
  require(checked.has_value() == is_curve(written), "a curve is taken for what it is not");
  if (!checked) require_error(checked.error(), {ErrorCode::kUsage});
  if (checked && (choices & 32) == 0) draw.volume = {.curve = std::make_shared<const TransferCurve>(written)};

  const TransferCurve curve = transfer_curve(draw, display);
  require(check_curve(curve).has_value(), "text gives an invalid curve");
  check_values(curve, grey);
  check_table(curve, static_cast<VoxelType>(choices >> 5));
}

const FuzzTarget kTransferCurves("transfer_curves", fuzz_transfer_curves);

}  // namespace
}  // namespace splatlas

// The warp of normal and high quality: cubic, where the picture shows the volume alone.
#pragma once

#include "player/shear.h"
#include "player/sheets.h"

namespace splatlas {

/// Samples the sheet at the centres of pixels [from, to) of a row of the picture, to `out`, 4 floats a pixel
/// from that of column 0 on: Catmull and Rom's cubic (1974) over 4 x 4 sheet pixels, third order, none of
/// which need be in the sheet. What overshoots at cliffs is cut off: 0 <= colour <= alpha <= 1. `map` leads
/// from picture coordinates to sheet pixels, `y` is the row's.
void warp_cubic(const SheetImage& sheet, const Affine2& map, double y, int from, int to, float* out);

/// The same at one place, in sheet pixels.
[[nodiscard]] Light sample_cubic(const SheetImage& sheet, double x, double y);

}  // namespace splatlas

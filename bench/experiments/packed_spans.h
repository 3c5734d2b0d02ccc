// Selected voxels packed into one array: the cost of compositing without skipping.
#pragma once

#include "player/render/sheets/sheets.h"
#include "player/render/sheets/spans/span_model.h"
#include "player/render/view/shear.h"

namespace splatlas {

/// Spans with the optical properties of the same voxels, in the same order, packed: full rows of a window,
/// slice after slice, without gaps except for the last voxel of each row. The picture is meaningless.
struct PackedSpans {
  SpanModel model;
  SheetWindow window;  ///< as large and fine as the original
  Shear shear;         ///< every slice at the same place, off the pixel grid
};

/// Packs the part of `model` inside `window`.
[[nodiscard]] PackedSpans pack_spans(const SpanModel& model, const Shear& shear, const SheetWindow& window);

}  // namespace splatlas

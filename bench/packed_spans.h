// The selected voxels of a model packed into one array: what compositing them costs with nothing to skip.
#pragma once

#include "player/sheets/sheets.h"
#include "player/spans/span_model.h"
#include "player/view/shear.h"

namespace splatlas {

/// Spans that hold the light of the same voxels in the same order, one after the other: whole rows of a
/// window, slice after slice, without a gap but the last voxel of each row. They composite to nonsense.
struct PackedSpans {
  SpanModel model;
  SheetWindow window;  ///< as large and as fine as the one it is made for
  Shear shear;         ///< every slice at the same place, off the pixels' own
};

/// Packs what `model` shows through `window`.
[[nodiscard]] PackedSpans pack_spans(const SpanModel& model, const Shear& shear, const SheetWindow& window);

}  // namespace splatlas

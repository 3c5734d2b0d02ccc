// Window of the footprints of a span model.
#pragma once

#include <span>

#include "player/camera.h"
#include "player/sheets/sheet_window.h"
#include "player/spans/span_model.h"
#include "player/view/cut_rays.h"
#include "player/view/shear.h"

namespace splatlas {

/// The window of all footprints of the model that overlap the picture, without those that `planes` remove.
[[nodiscard]] SheetWindow sheet_window(const SpanModel& model, const Shear& shear, const PictureSize& size,
                                       const SheetSampling& sampling,
                                       std::span<const VoxelPlane> planes = {});

}  // namespace splatlas

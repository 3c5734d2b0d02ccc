// Window of the footprints of a span model.
#pragma once

#include <span>

#include "player/camera.h"
#include "player/render/clip/cut_rays.h"
#include "player/render/sheets/spans/span_model.h"
#include "player/render/view/pixel_box.h"
#include "player/render/view/shear.h"
#include "player/render/view/sheet_window.h"

namespace splatlas {

/// The window of all footprints of the model that overlap the picture, without those that `planes` remove.
[[nodiscard]] SheetWindow sheet_window(const SpanModel& model, const Shear& shear, const PictureSize& size,
                                       const SheetSampling& sampling,
                                       std::span<const VoxelPlane> planes = {});

/// The part of a window that shows a region of the picture, with whole blocks of pixels of the window.
[[nodiscard]] SheetWindow part_of_window(const SheetWindow& window, const Shear& shear,
                                         const PixelBox& region);

}  // namespace splatlas

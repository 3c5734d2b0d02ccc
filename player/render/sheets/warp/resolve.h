// Warp of the sheet into the picture, composited with surface fragments.
#pragma once

#include <span>

#include "format/tasks/thread_pool.h"
#include "player/picture.h"
#include "player/render/clip/face_layer.h"
#include "player/render/sheets/sheet_sample.h"
#include "player/render/sheets/warp/sheet_image.h"
#include "player/render/sheets/warp/warp_kernels.h"
#include "player/render/view/pixel_box.h"
#include "player/render/view/shear.h"

namespace splatlas {

/// Surface fragments, and what is composited of them.
struct FragmentsInVolume {
  const FragmentList& list;
  std::span<const SheetSample> samples;  ///< as of the list
  const FaceLayer* faces = nullptr;      ///< of the cut, at pixel centres; null: none
};

/// Warps the sheet (Lacroute and Levoy 1994), and puts the rest of it behind the fragments. Interpolation in
/// the sheet is bilinear, or cubic for pixels without fragments if the window asks for it. Minified pixels
/// are the mean of several samples. Faces of a cut are composited in front of and behind everything else.
/// `painted`: the picture holds what is behind the volume, without fragments. Writes the pixels of a region.
/// Cost: linear in its pixels and fragments.
void resolve(const SheetImage& sheet, const Shear& shear, const FragmentsInVolume& fragments,
             const PixelBox& region, const WarpKernels& kernels, bool painted, Picture& picture,
             ThreadPool& pool);

}  // namespace splatlas

// The last pass: the finished sheet is warped into the picture, surfaces between the parts of the volume.
#pragma once

#include "format/system/thread_pool.h"
#include "player/picture.h"
#include "player/sheets/fragment_order.h"
#include "player/sheets/sheets.h"
#include "player/sheets/warp_kernels.h"
#include "player/view/shear.h"

namespace splatlas {

/// The surfaces of a picture, and the volume in front of each.
struct FragmentsInVolume {
  const FragmentList& list;
  const FragmentOrder& order;
};

/// Every pixel: the volume up to the first fragment, the fragment, the volume up to the next one, and so on;
/// exactly in order, because the volume in front of a fragment is known where the fragment is. Bilinear in
/// the sheet; where the sheet is finer than the picture, the mean of several samples. Cost: pixels plus
/// fragments.
void resolve(const SheetImage& sheet, const Shear& shear, const FragmentsInVolume& fragments,
             const PictureSize& size, const WarpKernels& kernels, Picture& picture, ThreadPool& pool);

}  // namespace splatlas

// The last pass: the finished sheet is warped into the picture, surfaces between the parts of the volume.
#pragma once

#include "player/fragment_order.h"
#include "player/picture.h"
#include "player/shear.h"
#include "player/sheets.h"
#include "player/thread_pool.h"
#include "player/warp_kernels.h"

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

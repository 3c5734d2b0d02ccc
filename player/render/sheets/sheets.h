// Volume pass: sheet splatting and compositing of slices, front to back.
#pragma once

#include <cstdint>
#include <span>

#include "format/tasks/thread_pool.h"
#include "player/render/clip/cut_rays.h"
#include "player/render/sheets/sheet_fragments.h"
#include "player/render/sheets/spans/build_spans.h"
#include "player/render/sheets/splat/splat_kernels.h"
#include "player/render/sheets/warp/sheet_image.h"
#include "player/render/view/shear.h"

namespace splatlas {

class SheetEnds;

/// Surfaces between the slabs of a volume.
struct SheetSurfaces {
  const FragmentList& list;
  const CutRays* cuts;              ///< clip the volume; null: no cut
  PictureSize size;                 ///< of the picture
  SheetFragments& fragments;        ///< receives the samples of the list, composited but for the whole volume
  const SheetEnds* ends = nullptr;  ///< rays end there, and the list is empty; null: no ends
};

/// Splats the slices into sheets (Westover 1990) in sheared object space (Lacroute and Levoy 1994) and
/// composites them front to back, with the fragments between them. A slab has the optical properties of its
/// slice or, between two slices, those interpolated at its centre. Early ray termination: blocks of pixels
/// may stop at a transmittance of `termination_threshold`. Bands of rows are independent and run in parallel;
/// the result does not depend on the number of threads. The planes of a cut clip the slabs (ClipSlabs).
/// Returns the number of splatted voxels, each counted once but for those at borders of strips; with a cut,
/// of spans that are not removed as a whole. Cost: visible voxels * scale^2 * parts, fragments and pixels.
[[nodiscard]] std::uint64_t render_sheets(const SheetSpans& spans, const Shear& shear,
                                          const SheetWindow& window, const SplatKernels& kernels,
                                          float termination_threshold, std::span<const VoxelPlane> planes,
                                          const Slabs& slabs, const SheetSurfaces& surfaces,
                                          SheetImage& image, ThreadPool& pool);

}  // namespace splatlas

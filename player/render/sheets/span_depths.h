// Depth map of volumes that are rendered by sheets.
#pragma once

#include <span>

#include "player/render/clip/cut_rays.h"
#include "player/render/depth_cue/depth_edges.h"
#include "player/render/sheets/spans/sheet_spans.h"
#include "player/render/view/shear.h"
#include "player/render/view/view_frame.h"

namespace splatlas {

/// Merges volumes, clipped by planes, into `depths`, by minimum. The depth of a ray is that of a
/// transmittance of 1/2, accurate to about 0.1 voxel. Depths are found in a sheet of one pixel per voxel, and
/// interpolated bilinearly if all four neighbours have one. Memory: 4 bytes per pixel of the sheet. Cost:
/// about a nanosecond per voxel of the spans' bounding box in each row.
void add_span_depths(const SheetSpans& spans, const Shear& shear, const ViewDepth& view,
                     std::span<const VoxelPlane> planes, DepthMap& depths, ThreadPool& pool);

}  // namespace splatlas

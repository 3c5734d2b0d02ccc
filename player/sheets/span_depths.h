// How far away volumes are, in frames of sheets.
#pragma once

#include "player/depth_cue/depth_edges.h"
#include "player/spans/span_model.h"
#include "player/view/shear.h"
#include "player/view/view_depth.h"

namespace splatlas {

/// Takes volumes into `depths` where they are nearer: where they let through no more than a half. Told to
/// about a tenth of a voxel at a sheet of one pixel a voxel, and in between bilinear where all four
/// neighbours have a depth. Takes 4 bytes for each voxel of a sheet that the picture shows. Cost: in the rows
/// of that, the box around the spans of each slice, a nanosecond or so per voxel.
void add_span_depths(const SpanModel& model, const Shear& shear, const ViewDepth& view, DepthMap& depths,
                     ThreadPool& pool);

}  // namespace splatlas

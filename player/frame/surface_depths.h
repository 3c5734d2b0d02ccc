// How far away the surfaces of a picture are.
#pragma once

#include <cstddef>

#include "player/depth_cue/depth_edges.h"
#include "player/surfaces/fragments.h"
#include "player/view/view_depth.h"

namespace splatlas {

/// Takes surfaces into `depths` where they are nearer: a pixel's nearest sample, each sample where its
/// surfaces let through no more than a half. Fragments' depths are `depth_sign` times places along
/// `depth_axis`.
void add_surface_depths(const FragmentList& fragments, std::size_t depth_axis, double depth_sign,
                        const ViewDepth& view, DepthMap& depths);

}  // namespace splatlas

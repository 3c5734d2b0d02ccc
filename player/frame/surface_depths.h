// Depths of the surfaces of a frame.
#pragma once

#include <cstddef>

#include "player/depth_cue/depth_edges.h"
#include "player/surfaces/fragments.h"
#include "player/view/view_depth.h"

namespace splatlas {

/// Merges the depths of surfaces into `depths` by minimum. The depth of a sample is that of the fragment at
/// which its transmittance falls to one half; a pixel takes its nearest sample. The depth of a fragment is
/// `depth_sign` * position along `depth_axis`, in voxels. O(fragments).
void add_surface_depths(const FragmentList& fragments, std::size_t depth_axis, double depth_sign,
                        const ViewDepth& view, DepthMap& depths);

}  // namespace splatlas

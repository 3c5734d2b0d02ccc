// Extents of a selection in a view.
#pragma once

#include <span>

#include "format/content/cut_planes.h"
#include "format/content/structure_graph.h"
#include "format/tasks/thread_pool.h"
#include "player/render/decode/class_cache.h"
#include "player/render/frame/drawn_selection.h"
#include "player/render/view/fit_extents.h"

namespace splatlas {

/// The part of a plan in some structures: classes with a membership in them, and their surfaces.
[[nodiscard]] DrawPlan part_of(const DrawPlan& plan, std::span<const StructureIndex> structures,
                               const Atlas& atlas);

/// Extents of the parts of a plan's voxels and surfaces that `cuts` keep. A voxel extends to the centres of
/// its neighbours, up to which interpolation spreads it. Empty for a plan that draws nothing. `cache` must
/// hold the plan's volume classes along `axis`, and its surfaces of the level. Cost: linear in the runs
/// within the bounding box of the plan, and in the vertices of its surfaces.
[[nodiscard]] FitExtents extents_of(const DrawPlan& plan, const Atlas& atlas, const ClassCache& cache,
                                    Axis axis, int surface_level, const CutPlanes& cuts,
                                    const FitPlanes& planes, ThreadPool& pool);

}  // namespace splatlas

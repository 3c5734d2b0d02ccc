// Time and error of every renderer in one scene.
#pragma once

#include <vector>

#include "bench/error_participants.h"

namespace splatlas {

/// Sets the errors (of full scale) of renderers in parallel projection with pre-classification, over
/// `views_compared` views, which are every second frame, against ground truth in double precision.
[[nodiscard]] Result<void> compare_parallel(std::vector<Participant>& participants, const ErrorTask& task,
                                            int views_compared);

/// Parallel projection, pre-classified: Splatlas at every quality with one and two threads, and VolPack.
/// Frames are interleaved. Errors (of full scale) as in compare_parallel().
[[nodiscard]] Result<std::vector<RendererCost>> measure_parallel(const ErrorTask& task, int views_compared);

/// Perspective projection, post-classified: Splatlas at every quality with one and two threads, and both VTK
/// mappers at these sample distances.
struct VtkSteps {
  std::vector<double> fixed_point_mm, gpu_mm;
};
[[nodiscard]] Result<std::vector<RendererCost>> measure_perspective(const ErrorTask& task,
                                                                    const VtkSteps& steps,
                                                                    int views_compared);

}  // namespace splatlas

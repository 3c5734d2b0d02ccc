// Time and error of every renderer in one scene.
#pragma once

#include <vector>

#include "bench/error_participants.h"

namespace splatlas {

/// Sets the errors (in full scales) of what draws in parallel projection, grey values classified before
/// interpolation: over the first `views_compared` views, every second frame, against the truth in double
/// precision.
[[nodiscard]] Result<void> compare_parallel(std::vector<Participant>& participants, const ErrorTask& task,
                                            int views_compared);

/// Parallel projection, grey values classified before interpolation: ours at every quality with one and with
/// two threads, and VolPack. Times are taken with frames interleaved, errors (in full scales) over the first
/// `views_compared` views, every second frame, against the truth in double precision.
[[nodiscard]] Result<std::vector<RendererCost>> measure_parallel(const ErrorTask& task, int views_compared);

/// Perspective projection, grey values classified after interpolation: ours at every quality with one and
/// with two threads, and VTK's two mappers at these distances between samples.
struct VtkSteps {
  std::vector<double> fixed_point_mm, gpu_mm;
};
[[nodiscard]] Result<std::vector<RendererCost>> measure_perspective(const ErrorTask& task,
                                                                    const VtkSteps& steps,
                                                                    int views_compared);

}  // namespace splatlas

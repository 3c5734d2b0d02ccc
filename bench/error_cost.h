// Time and error of every renderer in one scene.
#pragma once

#include <vector>

#include "bench/error_participants.h"

namespace splatlas {

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

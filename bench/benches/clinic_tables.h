// Tables of bench `scale` on a CT as large as a clinic's.
#pragma once

#include "bench/bench.h"

namespace splatlas {

/// Adds first pictures and steady drafts at the budget of the window, and the growth of steady frames of one
/// picture with eight times the voxels. Without the CT (head_ct.h): tells so, and adds nothing.
[[nodiscard]] Result<void> add_clinic(const BenchOptions& options, Report& report);

}  // namespace splatlas

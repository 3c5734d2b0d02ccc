// Cost of a picture that a plane cuts in half.
#pragma once

#include <memory>

#include "bench/bench.h"
#include "bench/measure/report.h"
#include "format/atlas_reader.h"

namespace splatlas {

/// Adds a table of the head, whole and without its left or its superior half, with faces, by sheets, rays and
/// surfaces, with the default shading. Summary, for sheets: `cut_left_draft`, `cut_left_normal`,
/// `cut_superior_draft`, `cut_superior_normal`: CPU time over that of the whole head, median over frames.
[[nodiscard]] Result<void> add_cut_table(const std::shared_ptr<const Atlas>& atlas,
                                         const BenchOptions& options, Report& report);

}  // namespace splatlas

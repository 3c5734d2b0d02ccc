// A CT of a head as large as a clinic's.
#pragma once

#include <array>
#include <filesystem>

#include "bench/bench.h"
#include "preprocess/build/build_atlas.h"

namespace splatlas {

/// The CT of 256 x 256 x 108 voxels in Debian's package invesalius-examples, interpolated linearly to `times`
/// the voxels along each axis: an atlas of "Bone" and "Soft tissue" by thresholds. Written to a folder that
/// the caller keeps, as TIMESxTIMESxTIMES.atlas. kFailed if the CT is missing or has another size.
[[nodiscard]] Result<BuildReport> build_head_ct(const std::array<int, 3>& times,
                                                const std::filesystem::path& folder,
                                                const BenchOptions& options);

/// The file of the CT.
[[nodiscard]] std::filesystem::path head_ct_file();

}  // namespace splatlas
